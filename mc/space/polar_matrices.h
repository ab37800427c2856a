#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/algebra/dual_dense.h"
#include "mc/space/space_slope.h"
#include "mc/transport/angular_grid.h"

namespace flatspeckle::mc {

/// Scattering between polar ordinates, in Galerkin's form, for each Fourier mode m of the azimuth:
/// between the polynomials of two panels it is exact, so that it conserves energy and is reciprocal
/// on any grid. Unknowns are radiance times sqrt(weight cos(theta)). Made for a mode when it is
/// first asked for, by any thread. Real: double, or Dual<double> for derivatives too.
template <typename Real>
class PolarMatricesOf {
 public:
  using Law = SpaceLawOf<Real>;

  PolarMatricesOf(const std::vector<Focus>& foci, int order, const Law& law, Real albedo);

  struct Scattering {
    MatrixOf<Real> difference, sum;  ///< forward minus, plus backward, times the albedo
  };
  const Scattering& of_mode(int m) const;
  const AngularGrid& grid() const { return grid_; }
  /// sqrt(weight cos(theta)), the weight that of a polynomial over cos(theta).
  const Eigen::VectorXd& root() const { return root_; }

 private:
  Scattering scattering(int m) const;

  AngularGrid grid_;
  const Law& law_;
  Real albedo_;
  Eigen::VectorXd root_;
  mutable std::mutex making_;
  mutable std::deque<Scattering> of_mode_;
};

/// Those of a slab, by foci and order; each is made once.
template <typename Real>
class PolarMatrixList {
 public:
  PolarMatrixList(const SpaceLawOf<Real>& law, Real albedo) : law_(law), albedo_(albedo) {}

  const PolarMatricesOf<Real>& at(const std::vector<Focus>& foci, int order) {
    const std::lock_guard lock(making_);
    return made_.try_emplace({foci, order}, foci, order, law_, albedo_).first->second;
  }

 private:
  const SpaceLawOf<Real>& law_;
  Real albedo_;
  std::mutex making_;
  std::map<std::pair<std::vector<Focus>, int>, PolarMatricesOf<Real>> made_;
};

}  // namespace flatspeckle::mc
