#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <map>
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
  OrdinatesOf(const std::vector<Focus>& foci, int order, double fine, Law law, Real albedo,
              const GridIndices& indices = {});

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

/// The layers of a slab, discretised on angular grids that differ only if the layers have different
/// refractive indices.
template <typename Geometry, typename Number>
class DiscreteSlabOf {
 public:
  using Slab = SlabOf<Geometry, Number>;
  using Ordinates = OrdinatesOf<Geometry, RealOf<Number>>;

  /// foci: angles in the layer of the largest index
  DiscreteSlabOf(const Slab& slab, const std::vector<Focus>& foci, int order) {
    for (const auto& layer : slab.layers)
      layers_.emplace_back(
          foci, order, slab.width(),
          layer.law.has_sharp_peak() ? layer.law.truncated(kept_moments(order)) : layer.law,
          layer.albedo, indices(slab, layer.index));
  }
  const std::deque<Ordinates>& layers() const { return layers_; }
  const AngularGrid& grid(std::size_t layer) const { return layers_[layer].grid(); }
  /// Returns the largest number of ordinates in a layer.
  Eigen::Index most_ordinates() const {
    Eigen::Index most = 0;
    for (const Ordinates& layer : layers_) most = std::max(most, layer.grid().size());
    return most;
  }

  /// Returns the fraction of the power that each face reflects; empty if no face reflects.
  std::vector<Eigen::VectorXd> reflectances(const Slab& slab) const {
    std::vector<Eigen::VectorXd> found;
    if (!slab.has_faces()) return found;
    const std::ptrdiff_t layers = std::ssize(slab.layers);
    for (std::ptrdiff_t l = 0; l <= layers; ++l) {
      // From the inside at the outer faces, else from the medium with the larger index
      const bool up = l == 0 || (l < layers && slab.index(l - 1) < slab.index(l));
      const Face face{slab.index(up ? l : l - 1), slab.index(up ? l - 1 : l), slab.polarisation};
      found.push_back(
          grid(static_cast<std::size_t>(up ? l : l - 1)).cosine().unaryExpr([&](double cosine) {
            return face.reflectance(cosine);
          }));
    }
    return found;
  }

 private:
  static GridIndices indices(const Slab& slab, double own) {
    std::map<double, bool> all{{slab.outside_index, false}};
    for (const auto& layer : slab.layers) all[layer.index] = true;
    GridIndices found{own, slab.largest_index()};
    for (const auto& [index, of_layer] : all)
      if (index < found.largest) found.smaller.push_back({index, of_layer});
    return found;
  }

  std::deque<Ordinates> layers_;
};

}  // namespace flatspeckle::mc
