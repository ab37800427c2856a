#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/unset.h"

namespace flatspeckle::wave {

/// Of a matrix that is filled by whoever makes it, column by column.
using Entries = std::vector<Complex, Unset<Complex>>;

}  // namespace flatspeckle::wave
