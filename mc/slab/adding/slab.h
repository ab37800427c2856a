#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

#include "flatland/media/faces.h"
#include "flatland/request/request.h"
#include "mc/slab/adding/bulk_derivative.h"
#include "mc/slab/adding/pair_wave.h"

namespace flatspeckle::mc {

// Slabs in the plane and in space share one implementation. A Geometry, PlaneGeometry (plane.h) or
// SpaceGeometry (mc/slab/adding/space.h), defines the differences: directions and their momenta,
// the phase function and its moments, and the functions of direction in which radiance is expanded.

/// One layer of a slab. mu_t and depth refer to the same unit of length.
template <typename Geometry, typename Real>
struct SlabLayerOf {
  double mu_t, depth;
  Real albedo;
  LawOf<Geometry, Real> law;
  double k;          ///< wavenumber in the layer
  double index = 1;  ///< refractive index
};

/// A slab. `departure` contains the frequency shift of the second field of each pair, or the
/// derivative of the mean free path by a parameter.
template <typename Geometry, typename Number>
struct SlabOf {
  using Layer = SlabLayerOf<Geometry, RealOf<Number>>;

  double k, mu_t, depth;      ///< k: wavenumber outside; mu_t: mean over the depth
  std::vector<Layer> layers;  ///< from the top down
  Departure<Number> departure{};
  double outside_index = 1;
  Polarisation polarisation = Polarisation::tm;

  /// Whether some face reflects.
  bool has_faces() const {
    return std::any_of(layers.begin(), layers.end(),
                       [this](const Layer& layer) { return layer.index != outside_index; });
  }
  /// Returns the index of layer l; that outside for l = -1 and for l = number of layers.
  double index(std::ptrdiff_t l) const {
    return l < 0 || l >= std::ssize(layers) ? outside_index
                                            : layers[static_cast<std::size_t>(l)].index;
  }
  /// Returns the largest index of a layer.
  double largest_index() const {
    double largest = 0;
    for (const Layer& layer : layers) largest = std::max(largest, layer.index);
    return largest;
  }
  /// Returns face l, which is above layer l, or below the last layer, for light that travels down.
  Face face(std::ptrdiff_t l) const { return {index(l - 1), index(l), polarisation}; }

  RealOf<Number> optical_depth(const Layer& layer) const {
    return layer.mu_t * layer.depth / departure.length;
  }
  /// Smallest angle over which the phase function of a layer varies.
  double width() const {
    double least = layers.front().law.width();
    for (const Layer& layer : layers) least = std::min(least, layer.law.width());
    return least;
  }
  /// Least number of nodes per panel that resolves the lobes of all phase functions.
  int least_order() const {
    int order = 0;
    for (const Layer& layer : layers) order = std::max(order, layer.law.least_order());
    return order;
  }
};

/// A request for covariances: directions of plane waves and of far views; channels, each an
/// illumination and a view; and entries, each the covariance of two channels. The two illuminations
/// of an entry must differ by the same transverse momentum as its two views (C18).
template <typename Direction>
struct RequestOf {
  std::vector<Direction> lights, views;
  std::vector<Channel> channels;
  std::vector<Entry> entries;
};

/// Returns the directions of a request.
template <typename Geometry>
RequestOf<typename Geometry::Direction> directions_of(const CovarianceRequest& of) {
  RequestOf<typename Geometry::Direction> request{{}, {}, of.channels, of.entries};
  for (const Light& light : of.lights)
    request.lights.push_back(Geometry::direction(light.angle, light.azimuth));
  for (const View& view : of.views)
    request.views.push_back(Geometry::direction(view.angle, view.azimuth));
  return request;
}

}  // namespace flatspeckle::mc
