#include "core/error.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

namespace {

/// A medium that varies, of points: of a uniform density that is nowhere exceeded, each is kept
/// with the share that its place has of it.
Placement thinned(const Scene& scene, RandomStream& random) {
  const MediumProfile& profile = *scene.profile;
  PlacementRule dense = scene.placement;
  dense.mean_count = profile.most_density() * scene.domain.area();
  Placement placement = draw_placement(scene.domain, scene.scatterer, dense, random);
  std::erase_if(placement, [&](PlacedScatterer& placed) {
    placed.scatterer = profile.materials()[profile.material_at(placed.position)].scatterer;
    return random.uniform() * profile.most_density() >= profile.density(placed.position);
  });
  return placement;
}

}  // namespace

Placement draw_placement(const Scene& scene, RandomStream& random) {
  if (!scene.profile) return draw_placement(scene.domain, scene.scatterer, scene.placement, random);
  if (scene.scatterer.is_disk())
    throw InputError("scatterer: of a medium that varies the exact solver takes points alone");
  return thinned(scene, random);
}

}  // namespace flatspeckle
