#pragma once

#include <vector>

#include "grin/render/methods/render_scene.h"

namespace flatspeckle::oracles {

/// Fluence rate at the distance r from an isotropic point source of power 1 in an infinite medium
/// of matched index that scatters isotropically, by transport theory (Case, de Hoffmann and
/// Placzek, Introduction to the Theory of Neutron Diffusion, 1953): a pole, which is what diffusion
/// has far away, and an integral over a branch cut, in which unscattered light is. Albedo from 0.1
/// to below 1.
double point_source_fluence(double mu_t, double albedo, double r);

/// A lamp in a ball of fog of extinction 1 that scatters isotropically, so wide (12) that light
/// hardly comes back from its rim, and a map beside the lamp: discs about an axis through it, from
/// 1 to 5 away.
grin::RenderScene lamp_map(double albedo);

/// The fluence rate of its cells, as in an infinite medium.
std::vector<double> lamp_fluence(double albedo);

}  // namespace flatspeckle::oracles
