#include "mc/slab/adding/ordinates.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mc/slab/adding/plane.h"
#include "mc/slab/adding/space.h"

namespace flatspeckle::mc {

namespace {

/// Returns the sum over degrees l = first, first + 2, .. of Geometry::weight(l) moments[l] v_l
/// v_l^T, where v_l is column l - m of `integrals`.
template <typename Geometry>
Matrix gram(const Matrix& integrals, const std::vector<double>& moments, int m, int first) {
  const Eigen::Index n = integrals.rows(), degrees = std::ssize(moments) - first,
                     count = std::max<Eigen::Index>((degrees + 1) / 2, 0);
  if (count == 0) return Matrix::Zero(n, n);
  Matrix taken(n, count), weighted(n, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto l = static_cast<int>(first + 2 * i);
    taken.col(i) = integrals.col(l - m);
    weighted.col(i) = Geometry::weight(l) * moments[static_cast<std::size_t>(l)] * taken.col(i);
  }
  return product(weighted, taken.transpose());
}

template <typename Geometry>
Dual<Matrix> gram(const Matrix& integrals, const Dual<std::vector<double>>& moments, int m,
                  int first) {
  return {gram<Geometry>(integrals, moments.value, m, first),
          gram<Geometry>(integrals, moments.derivative, m, first)};
}

}  // namespace

template <typename Geometry, typename Real>
OrdinatesOf<Geometry, Real>::OrdinatesOf(const std::vector<Focus>& foci, int order, double fine,
                                         Law law, Real albedo, const GridIndices& indices)
    : grid_(foci, order, fine, indices),
      law_(std::move(law)),
      albedo_(albedo),
      fine_(fine),
      root_(Geometry::weights(grid_).cwiseProduct(grid_.cosine()).unaryExpr([](double square) {
        return std::sqrt(square);
      })) {}

template <typename Geometry, typename Real>
auto OrdinatesOf<Geometry, Real>::of_mode(int m) const -> const Scattering& {
  const std::lock_guard lock(making_);
  while (std::ssize(of_mode_) <= m)
    of_mode_.push_back(scattering(static_cast<int>(of_mode_.size())));
  return of_mode_[static_cast<std::size_t>(m)];
}

template <typename Geometry, typename Real>
Matrix OrdinatesOf<Geometry, Real>::integrals(int m) const {
  const int last = degree(law_.moments());
  return grid_.integrals_of(std::max(last - m + 1, 0), [&](const Eigen::VectorXd& angles) {
    return Geometry::functions(angles, m, last);
  });
}

template <typename Geometry, typename Real>
std::array<Eigen::VectorXcd, 2> OrdinatesOf<Geometry, Real>::of_beam(double light, int m) const {
  const Matrix integrals = this->integrals(m);
  const auto shares = Geometry::beam(light, m, degree(law_.moments()));
  Eigen::VectorXcd forward = Eigen::VectorXcd::Zero(grid_.size()), backward = forward;
  for (Eigen::Index i = 0; i < integrals.cols(); ++i) {
    const auto l = static_cast<std::size_t>(i);
    const double moment = value_of(law_.moments())[l + static_cast<std::size_t>(m)];
    const Eigen::VectorXcd part = (moment * shares[l]) * integrals.col(i);
    forward += part;
    backward += i % 2 == 0 ? part : Eigen::VectorXcd(-part);
  }
  const Eigen::VectorXd scale = value_of(albedo_) * root_.cwiseInverse();
  return {scale.asDiagonal() * forward, scale.asDiagonal() * backward};
}

/// At the backward direction pi - theta, a function of degree l has (-1)^(l + m) times its value at
/// theta. Degrees m + 1, m + 3, .. therefore contribute only to the difference of forward and
/// backward scattering, and degrees m, m + 2, .. only to the sum.
template <typename Geometry, typename Real>
auto OrdinatesOf<Geometry, Real>::scattering(int m) const -> Scattering {
  const Matrix integrals = this->integrals(m);
  const Eigen::VectorXd scale = root_.cwiseInverse();
  const auto scaled = [&](const Matrix& a) -> Matrix {
    return scale.asDiagonal() * a * scale.asDiagonal();
  };
  const auto of_degrees = [&](int first) -> MatrixOf<Real> {
    return albedo_ * linear(scaled, gram<Geometry>(integrals, law_.moments(), m, first));
  };
  return {of_degrees(m + 1), of_degrees(m)};
}

template class OrdinatesOf<PlaneGeometry, double>;
template class OrdinatesOf<PlaneGeometry, Dual<double>>;
template class OrdinatesOf<SpaceGeometry, double>;
template class OrdinatesOf<SpaceGeometry, Dual<double>>;

}  // namespace flatspeckle::mc
