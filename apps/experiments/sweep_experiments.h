#pragma once

#include <string>
#include <vector>

#include "apps/command/command_line.h"

namespace flatspeckle::apps {

/// What the arguments, or the scene file that they name, say is to be swept; empty: memory-effect
/// curves.
std::string swept_subcommand(const Arguments& arguments);

/// `sweep --of`.
int sweep_experiments(const std::string& of, const Arguments& arguments);

/// `merge` of such a sweep's journals in these folders, of which there is one at least.
int merge_experiments(const std::vector<std::string>& folders, const std::string& out, bool partial,
                      const std::string& command_line);

}  // namespace flatspeckle::apps
