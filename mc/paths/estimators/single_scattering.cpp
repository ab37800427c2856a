#include "mc/paths/estimators/single_scattering.h"

namespace flatspeckle::mc {

Complex single_scattering(const Scene& scene, const PathWalks& walks, const FarField& a,
                          const FarField& b) {
  const Complex amplitudes = product_with_conjugate(walks.amplitude({}, a.light, a.view),
                                                    walks.amplitude({}, b.light, b.view));
  // Exactly 0 of equal fields.
  const Vec2 kappa =
      a.k * ((a.light - b.light) - (a.view - b.view)) + (a.k - b.k) * (b.light - b.view);
  return scene.medium.mu_s * amplitudes *
         attenuated_wave_integral(scene.domain, scene.medium.mu_t, kappa,
                                  {-a.light, a.view, -b.light, b.view});
}

std::vector<Complex> single_scattering(const Scene& scene, const PathWalks& walks) {
  const auto& request = scene.request;
  std::vector<Complex> entries(request.entries.size());
  for_entries(entries.size(), [&](std::size_t e) {
    entries[e] = single_scattering(scene, walks, FarField(scene, request.entries[e].a),
                                   FarField(scene, request.entries[e].b));
  });
  return entries;
}

}  // namespace flatspeckle::mc
