#pragma once

#include <cstdint>

#include "core/keys/keys.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

/// Refuses scatterers that are only known by bulk properties.
[[noreturn]] void refuse_bulk(const SceneSpec& spec);

/// Reads the placement of `solve` from the file that `placement` names. Throws InputError if keys
/// are given that describe random placements.
Placement placement_of_file(const Keys& keys, const SceneSpec& spec);

/// Draws the placement of `solve`. Throws InputError if the scene has no box or its scatterers are
/// only known by bulk properties.
Placement drawn_placement(const SceneSpec& spec, const Scene& scene, std::uint64_t seed);

/// Checks that the refractive index comes only from index_table. Throws InputError if it is also
/// given by the placement file or the key `index`, or if no scatterer has an index.
void require_index_from_table(const SceneSpec& spec, const Placement& placement);

/// Prints a note if a refractive index is so small that it may be meant as n - 1, which is given in
/// tables for gases or index contrasts.
void note_thin_index(const Placement& placement);

/// Returns a scene without bulk properties: an infinite layer with reflecting faces that contains
/// these point scatterers. Throws InputError if a scatterer is not a point of the layer.
Scene layer_around(const Faces& faces, const SceneSpec& spec, const Placement& placement);

}  // namespace flatspeckle::apps
