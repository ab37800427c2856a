#pragma once

#include "mc/paths/estimators/gradient.h"

namespace flatspeckle::mc {

/// Throws InputError for scenes for which layer_gradient_job() is not implemented: media that are
/// not layered, more than eight layers, layers that do not scatter, or near endpoints.
void check_layer_gradient(const Scene& scene);

/// Makes a job like gradient_job() for a layered medium. The parameters are mu_t, g and albedo of
/// each layer, if they are among the bulk_parameters() of the scene. The first parameter is named
/// "mu_t of layer 1".
GradientJob layer_gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
