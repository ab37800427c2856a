#pragma once

#include "mc/paths/estimators/gradient.h"

namespace flatspeckle::mc {

/// Throws InputError for what no derivatives by layers are of: another medium, too many layers, near
/// ends.
void check_layer_gradient(const Scene& scene);

/// As gradient_job(), of a medium of layers: by mu_t, g and albedo of each where these describe the
/// scatterers as a bulk, "mu_t of layer 1" the first.
GradientJob layer_gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
