#pragma once

#include <array>
#include <deque>
#include <mutex>
#include <vector>

#include "core/algebra/dual_dense.h"
#include "mc/slab/adding/angular_grid.h"
#include "mc/slab/adding/phase_moments.h"
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

  /// fine: the angle within which phase functions change.
  OrdinatesOf(const std::vector<Focus>& foci, int order, double fine, Law law, Real albedo);

  struct Scattering {
    MatrixOf<Real> difference, sum;  ///< forward minus, plus backward, times the albedo
  };
  /// Made when it is first asked for, by any thread.
  const Scattering& of_mode(int m) const;

  const AngularGrid& grid() const { return grid_; }
  const Law& law() const { return law_; }
  const Real& albedo() const { return albedo_; }
  /// The angle within which phase functions change.
  double fine() const { return fine_; }
  /// What the law's peak scatters, which goes on as if it were not scattered.
  Real not_turned() const { return albedo_ * law_.peak(); }
  /// What a beam scatters into mode m, down and up, by the moments that are kept.
  std::array<Eigen::VectorXcd, 2> of_beam(double light, int m) const;
  /// What the unknowns of mode 0 weigh in the integral of radiance over all directions.
  Eigen::VectorXd all_directions() const {
    return Geometry::all_directions() * root_.cwiseQuotient(grid_.cosine());
  }
  /// sqrt(weight cos(theta)), the weight that of a polynomial over cos(theta).
  const Eigen::VectorXd& root() const { return root_; }

 private:
  Scattering scattering(int m) const;
  Matrix integrals(int m) const;

  AngularGrid grid_;
  Law law_;
  Real albedo_;
  double fine_;
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
      layers_.emplace_back(
          foci, order, slab.width(),
          layer.law.has_sharp_peak() ? layer.law.truncated(kept_moments(order)) : layer.law,
          layer.albedo);
  }
  const std::deque<Ordinates>& layers() const { return layers_; }
  const AngularGrid& grid() const { return layers_.front().grid(); }
  /// Those of the grid.
  const Eigen::VectorXd& root() const { return layers_.front().root(); }

 private:
  std::deque<Ordinates> layers_;
};

}  // namespace flatspeckle::mc
