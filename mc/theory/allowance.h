#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Whether a far view lies within the first zeros of what a box's width diffracts of a plane wave
/// or beam that goes straight through: where the coherent field is.
inline bool in_forward_lobe(const Scene& scene, const Channel& channel) {
  const View& view = scene.request.views[channel.view];
  const Light& light = scene.request.lights[channel.light];
  if (scene.domain.kind != Domain::Kind::box || view.near || light.kind == Light::Kind::point ||
      std::cos(view.angle) <= 0)
    return false;
  const double q = scene.k * (std::sin(view.angle) - std::sin(light.angle));
  return std::abs(q) < 2 * std::numbers::pi / scene.domain.width;
}

/// Whether each placement of a box holds as many scatterers: disks are placed in whole numbers,
/// points where `count` says so.
inline bool has_fixed_number(const Scene& scene) {
  return scene.domain.kind == Domain::Kind::box &&
         (scene.scatterer.is_disk() || scene.placement.count);
}

/// Whether an exact covariance lacks the fluctuation of the coherent field that Monte Carlo has
/// (conventions, C12): a fixed number, and both channels in the forward lobe.
inline bool lacks_fluctuation(const Scene& scene, const Entry& entry) {
  const auto& channels = scene.request.channels;
  return has_fixed_number(scene) && in_forward_lobe(scene, channels[entry.a]) &&
         in_forward_lobe(scene, channels[entry.b]);
}

/// Least n^2 around the scatterers: where it is small the mean free path is shorter, and so is k.
inline double least_square(const Scene& scene) {
  if (!scene.index || !scene.index->is_quadratic()) return 1;
  const double half = scene.domain.width / 2;
  double least = scene.index->square({half, 0});
  for (const Vec2 corner :
       {Vec2{-half, 0}, {half, scene.domain.depth}, {-half, scene.domain.depth}})
    least = std::min(least, scene.index->square(corner));
  return least;
}

/// What the Monte Carlo method neglects, as a fraction: corrections of order 1/(k mean free path);
/// the shift of the wavenumber (refraction at the faces, local fields); and correlations, of order
/// the packing fraction where they are not taken in, of its square where they are (C16). As
/// data/bias_map.csv has it; a size, not a bound. A box that shifts the phase guides the mean
/// field, the more the further the critical angle sqrt(2 |k_shift| / k) leads across it over its
/// depth (measured for widths from 3 to 20).
struct Allowance {
  double crossed_paths, k_shift, guided, correlations;
  /// Flights that end within k a^2 of a disk, which is not seen from afar there: a share (k a)^2 /
  /// (k mean free path) of them. That map is of k a = 1, where this is in the first part.
  double near_zone;

  explicit Allowance(const Scene& scene)
      : crossed_paths(2 / (scene.k * scene.medium.mean_free_path() * least_square(scene))) {
    const double shift = std::abs(scene.medium.k_shift) / scene.k, depth = scene.domain.depth,
                 phase = std::min(1.0, scene.k * shift * depth),
                 across = std::min(1.0, std::sqrt(2 * shift) * depth / scene.domain.width);
    k_shift = 2 * shift;
    const bool refracted = scene.index && !scene.index->is_around(),
               guides = scene.domain.kind == Domain::Kind::box && !refracted;
    guided = guides ? 0.35 * phase * across : 0;
    const double packing = scene.medium.packing_fraction;
    correlations = scene.medium.structure.independent() ? packing : packing * packing;
    const double size = scene.scatterer.is_disk() ? scene.k * scene.scatterer.radius : 0;
    near_zone = std::max(0.0, size * size - 1) / (scene.k * scene.medium.mean_free_path());
  }
  double total() const { return crossed_paths + k_shift + guided + correlations; }
};

}  // namespace flatspeckle::mc
