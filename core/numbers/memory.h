#pragma once

#include <algorithm>
#include <unistd.h>

#include "core/numbers/address_space.h"

namespace flatspeckle {

/// Bytes of memory that this machine has.
inline double physical_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Of them, those that this process may have: `ulimit -v` may leave fewer.
inline double usable_memory() {
  return std::min(physical_memory(), address_space_left());
}

}  // namespace flatspeckle
