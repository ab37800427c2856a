#pragma once

#include <string>

#include "grin/design/goals/picture_goal.h"

namespace flatspeckle::grin::design {

/// A picture of a file of numbers, a line for each row, with commas or spaces between. Throws
/// InputError for one that is not square, has fewer than 4 rows, is dark or holds anything else
/// than numbers from 0 to 1e50.
Picture read_picture(const std::string& path, double width);

}  // namespace flatspeckle::grin::design
