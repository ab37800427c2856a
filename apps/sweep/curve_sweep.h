#pragma once

#include "apps/command/command_line.h"

namespace flatspeckle::apps {

/// `sweep` of memory-effect curves.
int curve_sweep(const Arguments& arguments);

}  // namespace flatspeckle::apps
