#pragma once

namespace flatspeckle::oracles {

/// Fluence rate at the distance r from an isotropic point source of power 1 in an infinite medium
/// of matched index that scatters isotropically, by transport theory (Case, de Hoffmann and
/// Placzek, Introduction to the Theory of Neutron Diffusion, 1953): a pole, which is what diffusion
/// has far away, and an integral over a branch cut, in which unscattered light is. Albedo from 0.1
/// to below 1.
double point_source_fluence(double mu_t, double albedo, double r);

}  // namespace flatspeckle::oracles
