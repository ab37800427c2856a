#pragma once

#include <algorithm>
#include <cstddef>
#include <unistd.h>

namespace flatspeckle {

/// Whether the address space is limited (`ulimit -v`).
bool address_space_is_limited();

/// Returns the number of bytes that this process can still map under the limit set by `ulimit -v`;
/// infinite if there is no limit.
double address_space_left();

/// Whether this process can still map this number of bytes (see address_space_left()). To be
/// checked before calls to libraries that hang or terminate the program if memory is missing.
bool address_space_holds(std::size_t bytes);

/// If the address space is limited, starts all threads of OpenMP now, because OpenMP terminates the
/// program if it cannot start a thread later. Throws InputError if the stacks and allocations of
/// the threads do not fit into the limit.
void require_address_space_of_threads(int threads);

/// Returns the physical memory of this machine in bytes.
inline double physical_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Returns the bytes of memory that this process may use: the physical memory, or less if `ulimit
/// -v` limits it.
inline double usable_memory() {
  return std::min(physical_memory(), address_space_left());
}

}  // namespace flatspeckle
