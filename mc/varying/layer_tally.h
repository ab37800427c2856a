#pragma once

#include <array>

#include "flatland/media/layers.h"
#include "mc/ends/space_direction.h"
#include "mc/jobs/bulk_parameter.h"

namespace flatspeckle::mc {

/// More than these have no derivatives.
inline constexpr std::size_t most_layers_with_derivatives = 8;

/// A number for each layer.
using PerLayer = std::array<double, most_layers_with_derivatives>;

/// What the logarithm of a path's integrand depends on, layer by layer: prod mu_s over its
/// scatterers, exp(-mu_t length) of its flights, and its phase functions.
struct LayerTally {
  const Layers* layers = nullptr;
  PerLayer scatterers{}, length{};
  PerLayer phase_slope{};  ///< sum of d log p / d g over the inner scatterers

  void flight(Vec2 x, const SpaceDirection& to, double r) {
    const Vec2 w = to;
    layers->each_part(x, w, r, [this](std::size_t layer, double part) { length[layer] += part; });
    ++scatterers[layers->material_at(x + r * w)];
  }
  void scattering(Vec2 x, const SpaceDirection& from, const SpaceDirection& to) {
    const std::size_t layer = layers->material_at(x);
    phase_slope[layer] +=
        henyey_greenstein_slope(layers->materials()[layer].medium.g, one_minus_cosine(from, to));
  }
};

}  // namespace flatspeckle::mc
