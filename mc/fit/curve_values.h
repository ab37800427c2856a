#pragma once

#include <span>
#include <vector>

#include "mc/fit/measurement.h"

namespace flatspeckle::mc {

/// A scene of the plane or, with dimension = 3, of space. Throws InputError.
Scene scene_of(const SceneSpec& spec);

bool is_flux(Observable observable);

/// Reversed paths add about 1 / (k l* angle) of what is seen at this angle from backscattering:
/// whether that is a thousandth or more in some view.
bool needs_reversed(const Scene& scene);

/// Adds the channels and entries of another request, as pairs.
void join(CovarianceRequest& all, const CovarianceRequest& more);

/// Those of a curve, of the covariance entries of its request.
std::vector<double> observed(const Curve& curve, const CovarianceRequest& request,
                             std::span<const Complex> entries);

}  // namespace flatspeckle::mc
