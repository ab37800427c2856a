#pragma once

namespace flatspeckle::grin {

/// How fast light of all directions dies out with depth deep inside a medium, per mean free path
/// and as a factor: exp(-rate mu_t z). The smallest root of the transport equation's dispersion
/// relation for Henyey-Greenstein scattering in flatland or in space; 0 without absorption.
double diffusion_rate(double albedo, double g, int dimension);

}  // namespace flatspeckle::grin
