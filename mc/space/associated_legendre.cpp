#include "mc/space/associated_legendre.h"

#include <cmath>

namespace flatspeckle::mc {

Matrix associated_legendre(const Eigen::VectorXd& angle, int m, int last) {
  if (last < m) return Matrix(angle.size(), 0);
  const Eigen::ArrayXd cosine = angle.array().cos(), sine = angle.array().sin();
  const double order = m;
  Matrix values(angle.size(), last - m + 1);
  values.col(0).setConstant(std::sqrt(0.5));
  for (int i = 1; i <= m; ++i) values.col(0).array() *= std::sqrt(1 + 0.5 / i) * sine;
  for (int l = m + 1; l <= last; ++l) {
    const double a = std::sqrt((4.0 * l * l - 1) / ((l - order) * (l + order))),
                 b = std::sqrt((l - 1 - order) * (l - 1 + order) / (4.0 * (l - 1) * (l - 1) - 1));
    const Eigen::Index i = l - m;
    values.col(i) = a * cosine * values.col(i - 1).array();
    if (i > 1) values.col(i) -= a * b * values.col(i - 2);
  }
  return values;
}

}  // namespace flatspeckle::mc
