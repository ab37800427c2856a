#pragma once

#include <algorithm>
#include <vector>

#include "flatland/request/request.h"
#include "mc/slab/adding/bulk_slope.h"
#include "mc/slab/adding/pair_wave.h"

namespace flatspeckle::mc {

// Slabs in the plane and in space are one code. A Geometry, PlaneGeometry (plane.h) or
// SpaceGeometry (mc/slab/adding/space.h), has what differs: directions and their momenta, the phase
// function and its moments, and the functions of direction in which radiance is expanded.

/// Lengths in one unit; one of the slab's layers.
template <typename Geometry, typename Real>
struct SlabLayerOf {
  double mu_t, depth;
  Real albedo;
  LawOf<Geometry, Real> law;
};

/// A slab, and how the second fields of pairs, or what it is differentiated by, depart from it.
template <typename Geometry, typename Number>
struct SlabOf {
  using Layer = SlabLayerOf<Geometry, RealOf<Number>>;

  double k, mu_t, depth;      ///< mu_t: on the mean over the depth
  std::vector<Layer> layers;  ///< from the top down
  Departure<Number> departure{};

  RealOf<Number> optical_depth(const Layer& layer) const {
    return layer.mu_t * layer.depth / departure.length;
  }
  /// The angle within which phase functions change.
  double width() const {
    double least = layers.front().law.width();
    for (const Layer& layer : layers) least = std::min(least, layer.law.width());
    return least;
  }
  /// Nodes of a panel that see the lobes of phase functions.
  int least_order() const {
    int order = 0;
    for (const Layer& layer : layers) order = std::max(order, layer.law.least_order());
    return order;
  }
};

/// What a covariance is asked for: plane waves and far views by their directions, and entries whose
/// pairs of lights and views differ by the same transverse momentum (C18).
template <typename Direction>
struct RequestOf {
  std::vector<Direction> lights, views;
  std::vector<Channel> channels;
  std::vector<Entry> entries;
};

/// In space: in the plane y = 0.
template <typename Geometry>
RequestOf<typename Geometry::Direction> directions_of(const CovarianceRequest& plane) {
  RequestOf<typename Geometry::Direction> request{{}, {}, plane.channels, plane.entries};
  for (const Light& light : plane.lights)
    request.lights.push_back(Geometry::direction(light.angle));
  for (const View& view : plane.views) request.views.push_back(Geometry::direction(view.angle));
  return request;
}

}  // namespace flatspeckle::mc
