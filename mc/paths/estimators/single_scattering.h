#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/run/parallel.h"
#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/wave_integral.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// A plane wave seen in a far view, at a wavenumber; unit vectors.
struct FarField {
  double k = 0;
  Vec2 light, view;

  FarField() = default;
  /// Of a channel of the scene.
  FarField(const Scene& scene, std::size_t channel) : k(scene.k) {
    const Channel c = scene.request.channels[channel];
    light = direction(scene.request.lights[c.light].angle);
    view = direction(scene.request.views[c.view].angle);
  }
};

/// The part B = 1 of the covariance of two fields (conventions, C14).
Complex single_scattering(const Scene& scene, const PathWalks& walks, const FarField& a,
                          const FarField& b);

/// Calls f with the number of each entry, in parallel where there are many: of some ten
/// microseconds to a millisecond each.
template <typename F>
void for_entries(std::size_t entries, F f) {
  constexpr std::size_t many = 100;
  parallel_for(entries, entries > many, f);
}

/// The same per entry of the request: far lights and views only. What no path has to sample.
std::vector<Complex> single_scattering(const Scene& scene, const PathWalks& walks);

}  // namespace flatspeckle::mc
