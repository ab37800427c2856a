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

/// Scattering in a layer from any ordinate of an angular grid to any other, discretised by
/// Galerkin's method, separately for each mode of direction. In space the modes are Fourier modes
/// of the azimuth about z; in the plane mode 0 contains the functions that are even in the angle to
/// z, and mode 1 the odd ones. The integrals of the phase function over the polynomials of two
/// panels are exact. Scattering therefore conserves energy and is reciprocal on any grid, and
/// forward peaks that the ordinates do not resolve cause no error where radiance is smooth. The
/// unknowns are radiance times root(). Real: double, or Dual<double> to include derivatives.
template <typename Geometry, typename Real>
class OrdinatesOf {
 public:
  using Law = LawOf<Geometry, Real>;

  /// fine: smallest angle over which a phase function varies.
  OrdinatesOf(const std::vector<Focus>& foci, int order, double fine, Law law, Real albedo);

  struct Scattering {
    /// Matrices albedo (F - B) and albedo (F + B), with the forward scattering F, within the upward
    /// or the downward directions, and the backward scattering B between them.
    MatrixOf<Real> difference, sum;
  };
  /// Returns the scattering of mode m, which is computed at the first call. May be called from
  /// several threads.
  const Scattering& of_mode(int m) const;

  const AngularGrid& grid() const { return grid_; }
  const Law& law() const { return law_; }
  const Real& albedo() const { return albedo_; }
  /// Smallest angle over which a phase function varies.
  double fine() const { return fine_; }
  /// Fraction of the extinction that is due to scattering into the forward peak of the phase
  /// function. Light in this peak is treated as unscattered.
  Real peak_scattering() const { return albedo_ * law_.peak(); }
  /// Returns the radiance of mode m, downwards and upwards, that a beam at the angle `light` causes
  /// by scattering. Only the kept moments of the phase function are used.
  std::array<Eigen::VectorXcd, 2> of_beam(double light, int m) const;
  /// Returns the weights of the unknowns of mode 0 in the integral of radiance over all directions.
  Eigen::VectorXd all_directions() const {
    return Geometry::all_directions() * root_.cwiseQuotient(grid_.cosine());
  }
  /// Returns sqrt(weight cos(theta)) at each ordinate theta, with the quadrature weights
  /// Geometry::weights().
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

/// The layers of a slab, discretised on one angular grid.
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
  /// Returns OrdinatesOf::root(), which is the same for all layers.
  const Eigen::VectorXd& root() const { return layers_.front().root(); }

 private:
  std::deque<Ordinates> layers_;
};

}  // namespace flatspeckle::mc
