#include "apps/flatland/solve_places.h"

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <string>

#include "apps/flatland/own_places.h"
#include "apps/flatland/space_solve.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::apps {

void refuse_bulk(const SceneSpec& spec) {
  throw InputError("scatterer", spec.scatterer,
                   std::string("is a bulk phase function; must be point, soft, hard") +
                       (spec.dimension == 3 ? " or penetrable" : ", tm or te"));
}

Placement placement_of_file(const Keys& keys, const SceneSpec& spec) {
  const Scatterer scatterer = make_scatterer(keys, spec);
  if (scatterer.is_bulk()) refuse_bulk(spec);
  const std::string& path = *keys.read(spec.placement);
  try {
    keys.refuse_unread();
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + " (the placement comes from " + path + ')');
  }
  Placement placement = read_placement(path, scatterer, spec.dimension == 3);
  const Table table = read_csv(path);
  if (table.has("radius")) {
    keys.disregard(spec.radius);
    keys.disregard(spec.diameter);
  }
  if (table.has("index_re")) keys.disregard(spec.index);
  return placement;
}

Placement drawn_placement(const SceneSpec& spec, const Scene& scene, std::uint64_t seed) {
  if (scene.domain.kind == Domain::Kind::slab)
    throw InputError("domain", spec.domain, "must be box for the exact solver");
  if (!scene.medium.has_scatterers) refuse_bulk(spec);
  if (spec.dimension == 3) require_uniform_space(scene);
  RandomStream random(seed, static_cast<std::uint64_t>(Stream::placement), 0);
  return draw_placement(scene, random);
}

void require_index_from_table(const SceneSpec& spec, const Placement& placement) {
  if (spec.index) throw InputError("index_table, index: give only one of them");
  if (has_own_places(spec) && read_csv(*spec.placement).has("index_re"))
    throw InputError("index_table: " + *spec.placement +
                     " also has indices (index_re); leave one out");
  if (std::ranges::none_of(placement, &Scatterer::is_penetrable, &PlacedScatterer::scatterer))
    throw InputError("index_table: requires tm or te cylinders");
}

void note_thin_index(const Placement& placement) {
  // gas bubbles in solids have an index, relative to the solid, down to about this value
  constexpr double rare = 0.8;
  const auto thin = std::ranges::find_if(placement, [](const PlacedScatterer& placed) {
    const Complex index = placed.scatterer.index;
    return placed.scatterer.is_penetrable() && index.imag() == 0 && index.real() < rare;
  });
  if (thin != placement.end())
    std::cerr << "note: index " << number_text(thin->scatterer.index.real())
              << " is far below the index of the surroundings, 1; if it is n - 1, give n instead\n";
}

Scene layer_around(const Faces& faces, const SceneSpec& spec, const Placement& placement) {
  Scene scene;
  scene.faces = faces;
  refuse_unpolarised(scene);
  scene.wavelength = spec.inside_wavelength();
  scene.k = 2 * std::numbers::pi / scene.wavelength;
  if (placement.empty() || placement.front().scatterer.is_disk())
    throw InputError("medium_index", *spec.medium_index, "requires at least one point scatterer");
  const auto [low, high] = bounds_of(placement, &PlacedScatterer::position);
  scene.domain = Domain{Domain::Kind::slab, high.x - low.x, *spec.depth};
  if (!(low.z > 0 && high.z < scene.domain.depth))
    throw InputError("placement", *spec.placement, "must have all z between 0 and depth");
  scene.request = intensity_request(spec.light_angles, far_views(spec.view_angles));
  return scene;
}

}  // namespace flatspeckle::apps
