#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/run/parallel.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// int dx exp(i kappa.x - mu_t/2 sum_j d(x, u_j)) over a box, or over the depth of a slab at x = 0,
/// where d is the distance to the edge along a unit vector: exact in depth, by Gauss-Legendre
/// quadrature across, cut where the integrand has kinks. Relative to the area about 1e-9.
Complex attenuated_wave_integral(const Domain& domain, double mu_t, Vec2 kappa,
                                 const std::array<Vec2, 4>& towards);

/// The part B = 1 of the covariance, per entry of the request: far lights and views only. What no
/// path has to sample (conventions, C14).
template <typename Scattering>
std::vector<Complex> single_scattering(const Scene& scene, const Scattering& scattering) {
  const auto& request = scene.request;
  std::vector<Complex> entries(request.entries.size());
  constexpr std::size_t many = 100;  // of some ten microseconds to a millisecond each
  parallel_for(entries.size(), entries.size() > many, [&](std::size_t e) {
    const auto end = [&](std::size_t channel) {
      const Channel c = request.channels[channel];
      return std::array{direction(request.lights[c.light].angle),
                        direction(request.views[c.view].angle)};
    };
    const auto [i1, v1] = end(request.entries[e].a);
    const auto [i2, v2] = end(request.entries[e].b);
    const Complex amplitudes =
        product_with_conjugate(scattering.amplitude(i1, v1), scattering.amplitude(i2, v2));
    entries[e] = scene.medium.mu_s * amplitudes *
                 attenuated_wave_integral(scene.domain, scene.medium.mu_t,
                                          scene.k * ((i1 - i2) - (v1 - v2)), {-i1, v1, -i2, v2});
  });
  return entries;
}

}  // namespace flatspeckle::mc
