#include "wave_solver/layered/layer_fields.h"

#include <functional>
#include <utility>

#include "core/error.h"
#include "core/result/result_group.h"
#include "wave_solver/points/foldy_lax.h"

namespace flatspeckle::wave {

LayerFields::LayerFields(const LayerWaves& waves, double width, std::vector<double> light_angles,
                         std::vector<double> view_angles)
    : green_(waves, width),
      light_angles_(std::move(light_angles)),
      view_angles_(std::move(view_angles)) {}

std::vector<Complex> LayerFields::of(const Placement& placement) const {
  if (placement.empty()) return std::vector<Complex>(light_angles_.size() * view_angles_.size());
  const LayerWaves& waves = green_.waves();
  std::vector<Complex> lights, views;
  for (const double angle : light_angles_)
    for (const auto& placed : placement)
      lights.push_back(waves.illuminated(angle, placed.position));
  for (const double angle : view_angles_)
    for (const auto& placed : placement) views.push_back(waves.emitted(angle, placed.position));
  return foldy_lax(placement, waves.k(), std::cref(green_), lights, views);
}

LayerFields layer_fields(const Scene& scene) {
  if (scene.scatterer.kind != Scatterer::Kind::point)
    throw InputError(
        "medium_index", scene.faces->inside,
        "the exact solver of a layer with reflecting faces requires scatterer = point");
  return {LayerWaves(*scene.faces, scene.k, scene.domain.depth), scene.domain.width,
          scene.request.lights.angles(), column(scene.request.views, &View::angle)};
}

}  // namespace flatspeckle::wave
