#pragma once

#include <vector>

namespace flatspeckle::grin {

/// Returns the rate at which light decays with depth deep inside a medium, per mean free path.
/// There, the light of all directions decays as exp(-rate mu_t z). The rate is the smallest root of
/// the transport equation's dispersion relation for Henyey-Greenstein scattering in flatland or in
/// space; 0 without absorption.
double diffusion_rate(double albedo, double g, int dimension);

/// Returns the smallest roots of the dispersion relation in ascending order, at most `count`:
/// diffusion_rate(), and others up to `highest`, which is below 1.
std::vector<double> discrete_rates(double albedo, double g, int dimension, int count,
                                   double highest);

}  // namespace flatspeckle::grin
