#pragma once

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

}  // namespace flatspeckle::mc
