#include "flatland/scene/periodic_placement.h"

#include <cmath>
#include <cstdint>

#include "core/error.h"
#include "flatland/placement/cell_grid.h"

namespace flatspeckle {

namespace {

// Places disks by random sequential addition. A disk near a side is also inserted beyond the other
// side, as an image.
Placement add_periodic_disks(const Scene& scene, RandomStream& random) {
  const Domain& box = scene.domain;
  const double contact = 2 * scene.scatterer.radius + scene.placement.min_gap;
  const auto count = static_cast<std::size_t>(std::llround(scene.placement.mean_count));
  check_packing(
      box, scene.placement.kind,
      static_cast<double>(count) * Scatterer{.radius = contact / 2}.content(2) / box.content(),
      contact);
  CellGrid grid(contact);
  Placement placement;
  constexpr std::uint64_t most_tries = 100'000'000;
  for (std::uint64_t tries = 0; placement.size() < count; ++tries) {
    if (tries == most_tries)
      throw InputError(
          "the disks cannot be packed by random sequential addition; lower the density or min_gap");
    const Vec r{(random.uniform() - 0.5) * box.width, random.uniform() * box.depth};
    if (grid.any_near(r, [&](Vec other, std::size_t) { return length(r - other) < contact; }))
      continue;
    for (const double side : {-box.width, 0.0, box.width})
      if (std::abs(r.x + side) <= box.width / 2 + contact)
        grid.insert(r + Vec{side, 0}, placement.size());
    placement.push_back({r, scene.scatterer});
  }
  return placement;
}

}  // namespace

Placement draw_periodic_placement(const Scene& scene, RandomStream& random) {
  if (scene.profile || scene.index || scene.faces || scene.domain.height > 0)
    throw InputError(
        "a periodic cell requires a homogeneous medium in the plane, without layers, index_field "
        "and medium_index");
  const bool added =
      scene.scatterer.is_disk() && scene.placement.kind == PlacementRule::Kind::hard_disk;
  return added ? add_periodic_disks(scene, random) : draw_placement(scene, random);
}

}  // namespace flatspeckle
