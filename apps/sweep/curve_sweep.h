#pragma once

#include "apps/command/subcommands.h"

namespace flatspeckle::apps {

/// `sweep` of memory-effect curves.
std::unique_ptr<Call> curve_sweep();

}  // namespace flatspeckle::apps
