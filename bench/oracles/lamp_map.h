#pragma once

#include <vector>

#include "grin/render/methods/render_scene.h"

namespace flatspeckle::oracles {

/// A lamp in a ball of fog of extinction 1 that scatters isotropically, so wide (12) that light
/// hardly comes back from its rim, and a map beside the lamp: discs about an axis through it, from
/// 1 to 5 away.
grin::RenderScene lamp_map(double albedo);

/// The fluence rate of its cells (infinite_medium.h).
std::vector<double> lamp_fluence(double albedo);

}  // namespace flatspeckle::oracles
