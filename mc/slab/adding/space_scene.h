#pragma once

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// A slab that has the same keys in space: lights and views lie in the plane of incidence, the
/// medium has a phase function per steradian, and its `dimension` says so. Throws InputError for
/// boxes, and for scatterers of the plane: what may be in space is hg, two_term_hg, phase_table,
/// rayleigh and mie, whose albedo is that of its spheres.
Scene in_space(Scene slab, const ScattererValues& values);

}  // namespace flatspeckle::mc
