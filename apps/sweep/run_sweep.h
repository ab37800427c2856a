#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/sweep/sweep.h"

namespace flatspeckle::apps {

/// Puts together what folders hold of a sweep. make: the kind of sweep that a configuration is of.
/// partial: also where points are missing. Returns the exit status. Throws InputError.
int merge_sweep(const std::function<std::unique_ptr<Sweep>(const std::string& config)>& make,
                const std::vector<std::string>& folders, const std::string& out, bool partial,
                const std::string& command_line);

/// The folder beside a sweep's result in which its points gather until all are there.
std::string shards_of(const std::string& out);

}  // namespace flatspeckle::apps
