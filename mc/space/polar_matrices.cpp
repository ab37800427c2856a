#include "mc/space/polar_matrices.h"

#include <algorithm>
#include <cmath>

#include "mc/space/associated_legendre.h"
#include "mc/transport/bulk_slope.h"

namespace flatspeckle::mc {

namespace {

/// sum over l = m + first, m + first + 2, .. of moments[l] v_l v_l^T
Matrix moment_gram(const Matrix& integrals, const std::vector<double>& moments, int m, int first) {
  const auto rest = static_cast<Eigen::Index>(moments.size()) - m - first,
             count = std::max<Eigen::Index>((rest + 1) / 2, 0);
  Matrix taken(integrals.rows(), count), weighted(integrals.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    taken.col(i) = integrals.col(first + 2 * i);
    weighted.col(i) = moments[static_cast<std::size_t>(m + first + 2 * i)] * taken.col(i);
  }
  return product(weighted, taken.transpose());
}

Dual<Matrix> moment_gram(const Matrix& integrals, const Dual<std::vector<double>>& moments, int m,
                         int first) {
  return {moment_gram(integrals, moments.value, m, first),
          moment_gram(integrals, moments.slope, m, first)};
}

}  // namespace

template <typename Real>
PolarMatricesOf<Real>::PolarMatricesOf(const std::vector<Focus>& foci, int order, const Law& law,
                                       Real albedo)
    : grid_(foci, order, law.width()), law_(law), albedo_(albedo) {
  const Eigen::VectorXd weight = grid_.integrals_of(
      1, [](const Eigen::VectorXd& angle) -> Matrix { return angle.array().sin(); });
  root_ = weight.cwiseProduct(grid_.cosine()).unaryExpr([](double w) { return std::sqrt(w); });
}

template <typename Real>
auto PolarMatricesOf<Real>::of_mode(int m) const -> const Scattering& {
  const std::lock_guard lock(making_);
  while (static_cast<int>(of_mode_.size()) <= m)
    of_mode_.push_back(scattering(static_cast<int>(of_mode_.size())));
  return of_mode_[static_cast<std::size_t>(m)];
}

/// Backwards, theta -> pi - theta, P_l^m has the sign (-1)^(l + m).
template <typename Real>
auto PolarMatricesOf<Real>::scattering(int m) const -> Scattering {
  const int last = degree(law_.moments());
  const Matrix integrals =
      grid_.integrals_of(std::max(last - m + 1, 0), [&](const Eigen::VectorXd& angle) {
        const Eigen::VectorXd sine = angle.array().sin();
        return Matrix(sine.asDiagonal() * associated_legendre(angle, m, last));
      });
  const Eigen::VectorXd scale = root_.cwiseInverse();
  const auto scaled = [&](const Matrix& a) -> Matrix {
    return 2 * scale.asDiagonal() * a * scale.asDiagonal();
  };
  const auto of_degrees = [&](int first) -> MatrixOf<Real> {
    return albedo_ * linear(scaled, moment_gram(integrals, law_.moments(), m, first));
  };
  return {of_degrees(1), of_degrees(0)};
}

template class PolarMatricesOf<double>;
template class PolarMatricesOf<Dual<double>>;

}  // namespace flatspeckle::mc
