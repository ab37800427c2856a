#pragma once

#include <functional>

#include "flatland/scene/scene.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// The covariance of a slab's scene with finite ends on one side, the lights' or the views', per
/// entry: integrals of that of plane waves over directions, whose difference the entry's other ends
/// fix (C42). Not per length: a beam's total, what a near sensor receives of plane waves.
///   beam:     u(x) = int S(a) exp(i k w.(x - focus)) da, S = k cos(a - axis) (waist / (2 sqrt pi))
///             exp(-(k waist sin(a - axis) / 2)^2), GaussianBeam without its paraxial phase
///   source:   S = i / (4 pi), at the source, evanescent waves left out
///   sensor:   sqrt(k / (2 pi)) exp(i pi / 4) exp(i k w.y), of the far views' fields along w
/// solve: the covariance of plane waves, of a scene that has its own request (pairs).
Refined finite_ends_covariance(const Scene& slab, const Refinement& refinement,
                               const std::function<Refined(const Scene&)>& solve);

}  // namespace flatspeckle::mc
