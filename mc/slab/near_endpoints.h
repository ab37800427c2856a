#pragma once

#include <functional>

#include "flatland/scene/scene.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Returns the covariance of each entry for a slab whose illuminations, or whose sensors, are near
/// (not plane waves or far views). It is an integral over directions of the covariance of plane
/// waves. The far endpoints of an entry fix the difference of the sines of these directions (C42).
/// The result is not divided by the illuminated length: it is the covariance for a whole beam, or
/// at a near sensor under plane waves. With w the unit vector of direction a:
///   beam:    u(x) = int S(a) exp(i k w.(x - focus)) da,
///            S = k cos(a - axis) (waist / (2 sqrt pi)) exp(-(k waist sin(a - axis) / 2)^2),
///            which is GaussianBeam without its paraxial phase
///   source:  as the beam, with the point of the source as focus and S = i / (4 pi),
///            without evanescent waves
///   sensor:  u = int S exp(i k w.y) f(a) da at the point y, with the fields f of far views
///            and S = sqrt(k / (2 pi)) exp(i pi / 4)
/// solve: returns the covariance of plane waves for a scene whose request consists of pairs.
Refined near_endpoint_covariance(const Scene& slab, const Refinement& refinement,
                                 const std::function<Refined(const Scene&)>& solve);

}  // namespace flatspeckle::mc
