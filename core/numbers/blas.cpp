#include "core/numbers/blas.h"

#include <string>
#include <sys/mman.h>

#include <omp.h>

#include "core/error.h"

namespace flatspeckle {

void require_address_space_of_blas() {
  // mapped for each thread that calls; where it cannot be, OpenBLAS tries again for ever
  constexpr std::size_t buffer = std::size_t{128} << 20;
  const int threads = omp_in_parallel() ? omp_get_num_threads() : omp_get_max_threads();
  const std::size_t size = static_cast<std::size_t>(threads) * buffer;
  void* const mapped =
      mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapped == MAP_FAILED)
    throw InputError("BLAS needs 128 MiB of address space for each of " + std::to_string(threads) +
                     " threads, which ulimit -v does not leave; fewer threads (OMP_NUM_THREADS) "
                     "need less");
  munmap(mapped, size);
}

}  // namespace flatspeckle
