#pragma once

#include <functional>

#include "flatland/request/request.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Solves with smaller and smaller tolerances until the range of a memory_effect request is within
/// that of `refinement` too: the entries of a flat curve may be, and where it crosses not. Other
/// requests are solved once.
Refined refined_range(const CovarianceRequest& request, const Refinement& refinement,
                      const std::function<Refined(const Refinement&)>& solve);

}  // namespace flatspeckle::mc
