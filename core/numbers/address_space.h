#pragma once

#include <algorithm>
#include <cstddef>
#include <unistd.h>

namespace flatspeckle {

/// Whether there is a limit to it (`ulimit -v`).
bool address_space_is_limited();

/// Bytes that the limit leaves to this process; infinite without one.
double address_space_left();

/// Whether `ulimit -v` leaves so many bytes. Asked before libraries that wait for ever, or end the
/// program, where it does not.
bool address_space_holds(std::size_t bytes);

/// Starts so many threads for all that is parallel, where the address space is limited: OpenMP ends
/// the program where it cannot start one later. Throws InputError where their stacks, and what each
/// of them allocates, do not fit.
void require_address_space_of_threads(int threads);

/// Bytes of memory that this machine has.
inline double physical_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Of them, those that this process may have: `ulimit -v` may leave fewer.
inline double usable_memory() {
  return std::min(physical_memory(), address_space_left());
}

}  // namespace flatspeckle
