#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/run/parallel.h"
#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/coherent_field.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// A plane wave along `light`, detected in the far view along `view`, at the wavenumber k.
struct FarField {
  double k = 0;
  Vec light, view;

  FarField() = default;
  /// Makes the field of a channel of the scene.
  FarField(const Scene& scene, std::size_t channel) : k(scene.k) {
    const Channel c = scene.request.channels[channel];
    light = scene.request.lights[c.light].direction();
    view = scene.request.views[c.view].direction();
  }
};

/// Returns the contribution of paths of one scatterer to the covariance of two fields (B = 1 in
/// conventions, C14).
inline Complex single_scattering(const Scene& scene, const PathWalks& walks, const FarField& a,
                                 const FarField& b) {
  const Complex amplitudes = product_with_conjugate(walks.amplitude({}, a.light, a.view),
                                                    walks.amplitude({}, b.light, b.view));
  // This form makes kappa exactly 0 if both fields are equal.
  const Vec kappa =
      a.k * ((a.light - b.light) - (a.view - b.view)) + (a.k - b.k) * (b.light - b.view);
  return scene.medium.mu_s * amplitudes *
         attenuated_wave_integral(scene.domain, scene.medium.mu_t, kappa,
                                  {-a.light, a.view, -b.light, b.view});
}

/// Calls f with the number of each entry, in parallel if there are many entries. One call is
/// assumed to take from ten microseconds to a millisecond.
template <typename F>
void for_entries(std::size_t entries, F f) {
  constexpr std::size_t many = 100;
  parallel_for(entries, entries > many, f);
}

/// Returns the contribution of paths of one scatterer to each entry of the request, so that walks
/// need not sample these paths. All lights and views must be far.
inline std::vector<Complex> single_scattering(const Scene& scene, const PathWalks& walks) {
  const auto& request = scene.request;
  std::vector<Complex> entries(request.entries.size());
  for_entries(entries.size(), [&](std::size_t e) {
    entries[e] = single_scattering(scene, walks, FarField(scene, request.entries[e].a),
                                   FarField(scene, request.entries[e].b));
  });
  return entries;
}

}  // namespace flatspeckle::mc
