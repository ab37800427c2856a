#include "mc/space/space_scene.h"

#include <cmath>
#include <tuple>

#include "core/error.h"
#include "grin/media/phase_function.h"

namespace flatspeckle::mc {

namespace {

using Density = std::function<double(double)>;

Density density_in_space(const Scene& scene, const ScattererValues& values) {
  using Hg = grin::HenyeyGreenstein<3>;
  if (scene.scatterer.kind == Scatterer::Kind::hg)
    return [hg = Hg{scene.scatterer.g}](double angle) { return hg.density(angle); };
  if (values.scatterer == PhaseTable::word) return scene.medium.phase.density;  // in any unit
  if (values.scatterer != TwoTermHg::word)
    throw InputError("scatterer", values.scatterer,
                     "with dimension = 3: hg (g = 0 is isotropic), two_term_hg or phase_table");
  const auto& terms = std::get<TwoTermHg>(values.bulk);
  return [first = Hg{*terms.g}, second = Hg{*terms.g_back},
          share = *terms.forward_share](double angle) {
    return share * first.density(angle) + (1 - share) * second.density(angle);
  };
}

SpaceLaw law_of(const Density& density) {
  return SpaceLaw([=](double cosine) { return density(std::acos(cosine)); });
}

}  // namespace

Scene in_space(Scene slab, const ScattererValues& values) {
  BulkMedium& medium = slab.medium;
  medium.phase.density = density_in_space(slab, values);
  medium.dimension = 3;
  const auto moments = law_of(medium.phase.density).moments();
  medium.g = medium.phase.g = moments.size() > 1 ? moments[1] : 0;
  return slab;
}

SpaceSlab space_slab(const Scene& scene) {
  return {scene.k, scene.medium.mu_t, scene.domain.depth, scene.medium.albedo,
          law_of(scene.medium.phase.density)};
}

}  // namespace flatspeckle::mc
