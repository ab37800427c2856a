#pragma once

#include "grin/design/goals/goal.h"

namespace flatspeckle::grin::design {

/// Readings are to be the same, whatever that is: residuals are their distances from their mean,
/// over it.
std::unique_ptr<Goal> make_equal_goal();

}  // namespace flatspeckle::grin::design
