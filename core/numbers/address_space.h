#pragma once

#include <cstddef>

namespace flatspeckle {

/// Whether `ulimit -v` leaves so many bytes. Asked before libraries that wait for ever, or end the
/// program, where it does not.
bool address_space_holds(std::size_t bytes);

/// Throws InputError where the stacks of so many threads, and what each of them allocates, do not
/// fit.
void require_address_space_of_threads(int threads);

}  // namespace flatspeckle
