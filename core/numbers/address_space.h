#pragma once

#include <cstddef>

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

}  // namespace flatspeckle
