#pragma once

// Declarations of the system's BLAS and LAPACK, with the complex numbers of C++.

#include <algorithm>
#include <complex>
#include <cstddef>
#include <vector>

#include <cblas.h>

#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <lapacke.h>

namespace flatspeckle {

/// Returns the number of threads that may call BLAS at once. Throws InputError if the address space
/// is too small for the buffers that OpenBLAS maps for each of these threads; OpenBLAS would hang.
std::size_t threads_of_blas();

extern "C" void* blas_memory_alloc(int);
extern "C" void blas_memory_free(void*);

/// Makes OpenBLAS map `count` buffers for threads now; OpenBLAS keeps them for later use. At most
/// 128 are mapped, because OpenBLAS prints a warning for more than it was built for.
inline void map_blas_buffers(std::size_t count) {
  constexpr std::size_t most = 128;
  std::vector<void*> buffers(std::min(count, most));
  for (void*& buffer : buffers) buffer = blas_memory_alloc(0);
  for (void* buffer : buffers) blas_memory_free(buffer);
}

/// Limits BLAS to one thread: this program itself runs in parallel, and threads of BLAS would
/// compete with its threads. Call this function before any use of BLAS. Throws the exceptions of
/// threads_of_blas().
inline void blas_single_thread() {
  static const bool done = (openblas_set_num_threads(1), map_blas_buffers(threads_of_blas()), true);
  static_cast<void>(done);
}

inline blasint blas_size(std::size_t n) {
  return static_cast<blasint>(n);
}

}  // namespace flatspeckle
