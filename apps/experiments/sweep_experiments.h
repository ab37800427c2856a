#pragma once

#include <string>
#include <vector>

#include "apps/command/subcommands.h"

namespace flatspeckle::apps {

/// `sweep --of`.
std::unique_ptr<Call> sweep_of(const std::string& of);

/// `merge` of such a sweep's journals in these folders, of which there is one at least.
int merge_experiments(const std::vector<std::string>& folders, const std::string& out, bool partial,
                      const std::string& command_line);

}  // namespace flatspeckle::apps
