#pragma once

// The system's BLAS and LAPACK, with C++ complex numbers.

#include <algorithm>
#include <complex>
#include <cstddef>
#include <vector>

#include <cblas.h>

#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <lapacke.h>

namespace flatspeckle {

/// The threads that may call BLAS at once. Throws InputError where the address space is too small
/// for their buffers, without which OpenBLAS would wait for ever.
std::size_t threads_of_blas();

extern "C" void* blas_memory_alloc(int);
extern "C" void blas_memory_free(void*);

/// OpenBLAS keeps the buffers that it has mapped. It complains of more than it was made for.
inline void map_blas_buffers(std::size_t count) {
  constexpr std::size_t most = 128;
  std::vector<void*> buffers(std::min(count, most));
  for (void*& buffer : buffers) buffer = blas_memory_alloc(0);
  for (void* buffer : buffers) blas_memory_free(buffer);
}

/// Parallelism is ours, over realizations, boxes, tilts or columns: threads inside BLAS would only
/// compete with it. Call before any BLAS work. Throws as above.
inline void blas_single_thread() {
  static const bool done = (openblas_set_num_threads(1), map_blas_buffers(threads_of_blas()), true);
  static_cast<void>(done);
}

inline blasint blas_size(std::size_t n) {
  return static_cast<blasint>(n);
}

}  // namespace flatspeckle
