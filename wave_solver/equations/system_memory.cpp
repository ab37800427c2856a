#include "wave_solver/equations/system_memory.h"

#include <algorithm>
#include <string>

#include <omp.h>

#include "core/error.h"
#include "core/numbers/complex.h"
#include "core/numbers/memory.h"

namespace flatspeckle::wave {

int systems_at_work() {
  return omp_in_parallel() ? omp_get_num_threads() : 1;
}

// Once they are at work, others have taken their share of the address space.
double memory_of_system(int together) {
  constexpr double share = 0.9;
  const double address_space = address_space_left() / (omp_in_parallel() ? 1 : together);
  return share * std::min(physical_memory() / together, address_space);
}

void require_dense_memory(std::size_t unknowns, int together) {
  const auto n = static_cast<double>(unknowns);
  const double bytes = sizeof(Complex) * n * n, memory = memory_of_system(together);
  if (bytes <= memory) return;
  const auto whole = [](double value) { return std::to_string(static_cast<long long>(value)); };
  const bool many = together > 1;
  throw InputError("unknowns", unknowns,
                   "the dense matrix needs " + whole(bytes) + " bytes, there are " + whole(memory) +
                       (many ? " for each of " + std::to_string(together) + " threads" : "") +
                       "; take fewer scatterers, wider gaps" + (many ? ", fewer threads" : "") +
                       " or a larger tolerance");
}

}  // namespace flatspeckle::wave
