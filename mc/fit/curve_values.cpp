#include "mc/fit/curve_values.h"

#include <algorithm>
#include <cmath>

#include "mc/space/space_scene.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

Scene scene_of(const SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  return spec.dimension == 3 ? in_space(scene, spec) : scene;
}

bool is_flux(Observable observable) {
  return observable == Observable::reflectance || observable == Observable::transmittance;
}

bool needs_reversed(const Scene& scene) {
  constexpr double negligible = 1e-3;
  const double width = 1 / (scene.k * scene.medium.transport_mean_free_path());
  for (const Channel& channel : scene.request.channels) {
    const View& view = scene.request.views[channel.view];
    const Light& light = scene.request.lights[channel.light];
    if (view.near || light.kind != Light::Kind::plane) return true;
    if (std::cos(view.angle) > 0) continue;
    const double angle = std::abs(std::sin(light.angle) + std::sin(view.angle));
    if (angle * negligible < width) return true;
  }
  return false;
}

void join(CovarianceRequest& all, const CovarianceRequest& more) {
  const auto lights = static_cast<std::uint32_t>(all.lights.size()),
             views = static_cast<std::uint32_t>(all.views.size()),
             channels = static_cast<std::uint32_t>(all.channels.size());
  all.kind = CovarianceRequest::Kind::pairs;
  all.lights.insert(all.lights.end(), more.lights.begin(), more.lights.end());
  all.views.insert(all.views.end(), more.views.begin(), more.views.end());
  for (const Channel& channel : more.channels)
    all.channels.push_back({channel.light + lights, channel.view + views});
  for (const Entry& entry : more.entries)
    all.entries.push_back({entry.a + channels, entry.b + channels});
}

std::vector<double> observed(const Curve& curve, const CovarianceRequest& request,
                             std::span<const Complex> entries) {
  const bool intensity = curve.observable == Observable::intensity;
  const auto all = intensity ? std::vector<Complex>(entries.begin(), entries.end())
                             : field_correlation(request, entries);
  std::vector<double> values;
  for (const std::size_t entry : curve.entries) {
    const double value = all[entry].real();
    values.push_back(curve.observable == Observable::intensity_correlation ? value * value : value);
  }
  return values;
}

}  // namespace flatspeckle::mc
