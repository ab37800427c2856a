#pragma once

#include <string>

namespace flatspeckle {

/// What tells one run from another: its scene and seed as lines "key = value", and what else it was
/// made from. The first line of one identity that the other does not have.
std::string first_difference(const std::string& there, const std::string& here);

}  // namespace flatspeckle
