#pragma once

#include <vector>

#include "grin/render/methods/render_scene.h"

namespace flatspeckle::oracles {

/// Fluence rate at the distance r from an isotropic point source of power 1 in an infinite medium
/// of matched index that scatters isotropically, by transport theory [case1953]. It is the sum of a
/// pole, which is the asymptotic diffusion, and an integral over a branch cut, which contains the
/// unscattered light. The albedo must be at least 0.1 and below 1.
double point_source_fluence(double mu_t, double albedo, double r);

/// Returns the scene of a lamp in isotropically scattering fog of extinction 1. The fog fills a
/// ball of radius 12, so that hardly any light returns from its rim. The cells of the fluence map
/// are discs around an axis through the lamp, at distances from 1 to 5.
grin::RenderScene lamp_map(double albedo);

/// Returns the mean fluence rate in each cell of the map, for an infinite medium.
std::vector<double> lamp_fluence(double albedo);

}  // namespace flatspeckle::oracles
