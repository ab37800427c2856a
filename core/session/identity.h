#pragma once

#include <string>

#include "core/keys/keys.h"

namespace flatspeckle {

/// What tells one run from another: its scene and seed as lines "key = value", and what else it was
/// made from. The first line of one identity that the other does not have.
std::string first_difference(const std::string& there, const std::string& here);

/// The files that keys name and that were read, each by name and checksum, a line each.
std::string inputs_text(const Keys& keys);

}  // namespace flatspeckle
