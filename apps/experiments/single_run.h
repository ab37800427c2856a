#pragma once

#include "apps/command/command_line.h"
#include "apps/experiments/experiment.h"

namespace flatspeckle::apps {

/// The subcommand of this name as a call of the program. Returns its exit status.
int single_run(const std::string& name, const Arguments& arguments);

}  // namespace flatspeckle::apps
