#pragma once

#include <string>
#include <vector>

namespace flatspeckle::apps {

/// `merge` of the points of a sweep of memory-effect curves in these folders.
int merge_points(const std::vector<std::string>& folders, const std::string& out, bool partial,
                 const std::string& command_line);

}  // namespace flatspeckle::apps
