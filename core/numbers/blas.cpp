#include "core/numbers/blas.h"

#include <string>

#include <omp.h>

#include "core/error.h"
#include "core/numbers/address_space.h"

namespace flatspeckle {

std::size_t threads_of_blas() {
  // buffer: bytes that OpenBLAS maps for each thread that calls it; if mapping fails, OpenBLAS
  // retries forever. rest: bytes left for other allocations.
  constexpr std::size_t buffer = std::size_t{128} << 20, rest = std::size_t{16} << 20;
  const auto threads =
      static_cast<std::size_t>(omp_in_parallel() ? omp_get_num_threads() : omp_get_max_threads());
  if (!address_space_holds(threads * buffer + rest))
    throw InputError("BLAS needs 128 MiB of address space for each of " + std::to_string(threads) +
                     " threads, which ulimit -v does not leave; use fewer threads");
  return threads;
}

}  // namespace flatspeckle
