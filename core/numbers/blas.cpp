#include "core/numbers/blas.h"

#include <string>
#include <sys/mman.h>

#include <omp.h>

#include "core/error.h"

namespace flatspeckle {

namespace {

/// OpenBLAS maps so many bytes for each thread that calls it, and tries again where it cannot.
constexpr std::size_t buffer = std::size_t{128} << 20;

void require_address_space(std::size_t threads) {
  void* const mapped = mmap(nullptr, threads * buffer, PROT_NONE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapped == MAP_FAILED)
    throw InputError("BLAS needs 128 MiB of address space for each of " + std::to_string(threads) +
                     " threads, which ulimit -v does not leave; fewer threads (OMP_NUM_THREADS) "
                     "need less");
  munmap(mapped, threads * buffer);
}

}  // namespace

void blas_single_thread() {
  static const bool done = [] {
    openblas_set_num_threads(1);
    require_address_space(static_cast<std::size_t>(omp_in_parallel() ? omp_get_num_threads()
                                                                     : omp_get_max_threads()));
    return true;
  }();
  static_cast<void>(done);
}

}  // namespace flatspeckle
