#include "mc/paths/endpoint_factors/coherent_field.h"

#include <algorithm>

#include "mc/paths/endpoint_factors/wave_integral.h"

namespace flatspeckle::mc {

bool has_coherent_field(const Scene& scene) {
  return scene.domain.kind == Domain::Kind::box && scene.medium.has_scatterers && !scene.profile &&
         (!scene.index || !scene.index->is_around()) &&
         scene.request.lights.all(Light::Kind::plane) &&
         std::none_of(scene.request.views.begin(), scene.request.views.end(),
                      [](const View& view) { return view.near; });
}

std::vector<Complex> coherent_field(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  std::vector<Complex> field;
  for (const auto [light, view] : scene.request.channels) {
    const double from = scene.request.lights[light].angle, to = scene.request.views[view].angle;
    const Vec2 w = direction(from);
    field.push_back(medium.density * amplitude(medium.t_matrix, scene.k, to - from) *
                    attenuated_wave_integral(scene.domain, {medium.mu_t, -2 * medium.k_shift},
                                             scene.k * (w - direction(to)), {-w}));
  }
  return field;
}

}  // namespace flatspeckle::mc
