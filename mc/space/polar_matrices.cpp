#include "mc/space/polar_matrices.h"

#include <algorithm>
#include <cmath>

#include "mc/space/associated_legendre.h"

namespace flatspeckle::mc {

namespace {

/// sum over l = m + first, m + first + 2, .. of moments[l] v_l v_l^T
Matrix moment_gram(const Matrix& integrals, const std::vector<double>& moments, int m, int first) {
  const auto count = std::max<Eigen::Index>((integrals.cols() - first + 1) / 2, 0);
  Matrix taken(integrals.rows(), count), weighted(integrals.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    taken.col(i) = integrals.col(first + 2 * i);
    weighted.col(i) = moments[static_cast<std::size_t>(m + first + 2 * i)] * taken.col(i);
  }
  return product(weighted, taken.transpose());
}

}  // namespace

PolarMatrices::PolarMatrices(const std::vector<Focus>& foci, int order, const SpaceLaw& law,
                             double albedo)
    : grid_(foci, order, law.width()), law_(law), albedo_(albedo) {
  const Eigen::VectorXd weight = grid_.integrals_of(
      1, [](const Eigen::VectorXd& angle) -> Matrix { return angle.array().sin(); });
  root_ = weight.cwiseProduct(grid_.cosine()).unaryExpr([](double w) { return std::sqrt(w); });
}

const PolarMatrices::Scattering& PolarMatrices::of_mode(int m) const {
  const std::lock_guard lock(making_);
  while (static_cast<int>(of_mode_.size()) <= m)
    of_mode_.push_back(scattering(static_cast<int>(of_mode_.size())));
  return of_mode_[static_cast<std::size_t>(m)];
}

/// Backwards, theta -> pi - theta, P_l^m has the sign (-1)^(l + m).
PolarMatrices::Scattering PolarMatrices::scattering(int m) const {
  const auto last = static_cast<int>(law_.moments().size()) - 1;
  const Matrix integrals =
      grid_.integrals_of(std::max(last - m + 1, 0), [&](const Eigen::VectorXd& angle) {
        const Eigen::VectorXd sine = angle.array().sin();
        return Matrix(sine.asDiagonal() * associated_legendre(angle, m, last));
      });
  const Eigen::VectorXd scale = root_.cwiseInverse();
  const auto scaled = [&](int first) {
    return Matrix(2 * albedo_ * scale.asDiagonal() *
                  moment_gram(integrals, law_.moments(), m, first) * scale.asDiagonal());
  };
  return {scaled(1), scaled(0)};
}

}  // namespace flatspeckle::mc
