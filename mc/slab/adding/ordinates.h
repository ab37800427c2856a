#pragma once

#include <deque>
#include <mutex>
#include <vector>

#include "core/algebra/dual_dense.h"
#include "mc/slab/adding/angular_grid.h"
#include "mc/slab/adding/slab.h"

namespace flatspeckle::mc {

/// Scattering by a layer between the ordinates of an angular grid, in Galerkin's form, for each
/// mode of direction (of space the Fourier modes of the azimuth about z; of the plane 0 for what is
/// even and 1 for what is odd in the angle to z). Between the polynomials of two panels it is
/// integrated exactly, so that it conserves energy and is reciprocal on any grid, and forward peaks
/// that the ordinates do not see cost no accuracy where radiance is smooth. Unknowns are radiance
/// times root(). Real: double, or Dual<double> for derivatives too.
template <typename Geometry, typename Real>
class OrdinatesOf {
 public:
  using Law = LawOf<Geometry, Real>;

  /// fine: the angle within which phase functions change. The law must outlive it.
  OrdinatesOf(const std::vector<Focus>& foci, int order, double fine, const Law& law, Real albedo);

  struct Scattering {
    MatrixOf<Real> difference, sum;  ///< forward minus, plus backward, times the albedo
  };
  /// Made when it is first asked for, by any thread.
  const Scattering& of_mode(int m) const;

  const AngularGrid& grid() const { return grid_; }
  const Law& law() const { return law_; }
  const Real& albedo() const { return albedo_; }
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

/// A slab's layers on ordinates of one grid.
template <typename Geometry, typename Number>
class DiscreteSlabOf {
 public:
  using Ordinates = OrdinatesOf<Geometry, RealOf<Number>>;

  DiscreteSlabOf(const SlabOf<Geometry, Number>& slab, const std::vector<Focus>& foci, int order) {
    for (const auto& layer : slab.layers)
      layers_.emplace_back(foci, order, slab.width(), layer.law, layer.albedo);
  }
  const std::deque<Ordinates>& layers() const { return layers_; }
  const AngularGrid& grid() const { return layers_.front().grid(); }
  /// Those of the grid.
  const Eigen::VectorXd& root() const { return layers_.front().root(); }

 private:
  std::deque<Ordinates> layers_;
};

}  // namespace flatspeckle::mc
