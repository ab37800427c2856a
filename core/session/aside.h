#pragma once

#include <filesystem>

namespace flatspeckle {

/// Where a file that is in the way is kept: the first of NAME.aside-1, NAME.aside-2 ... that is
/// free.
std::filesystem::path free_aside(const std::filesystem::path& path);

}  // namespace flatspeckle
