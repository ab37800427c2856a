#pragma once

#include <vector>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Whether a plane wave along w is represented by others: wherever it reaches in the medium, one of
/// them whose direction differs by `spacing` (radians) at the most is weakened by no more than a
/// factor of exp(1.5) beyond it. By reversal the same holds for light that leaves along -w.
bool reached(const Scene& scene, Vec2 w, const std::vector<Vec2>& others, double spacing);

}  // namespace flatspeckle::mc
