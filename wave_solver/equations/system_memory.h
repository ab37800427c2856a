#pragma once

#include <cstddef>

namespace flatspeckle::wave {

/// Threads that solve systems of their own at this moment, this one included.
int systems_at_work();

/// Bytes that each of some systems, solved together, may take.
double memory_of_system(int together = systems_at_work());

/// Throws InputError where the dense matrix of so many unknowns needs more.
void require_dense_memory(std::size_t unknowns, int together = systems_at_work());

}  // namespace flatspeckle::wave
