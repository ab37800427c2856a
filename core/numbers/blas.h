#pragma once

// The system's BLAS and LAPACK, with C++ complex numbers.

#include <complex>
#include <cstddef>

#include <cblas.h>

#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <lapacke.h>

namespace flatspeckle {

/// Throws InputError where the address space is too small for OpenBLAS, which would wait for ever.
void require_address_space_of_blas();

/// OpenBLAS keeps the buffer that its first call maps.
inline void map_blas_buffer() {
  constexpr double triangle[] = {1, 0, 0, 1};
  double columns[4] = {};
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasUnit, 2, 2, 1, triangle, 2,
              columns, 2);
}

/// Parallelism is ours, over realizations, boxes, tilts or columns: threads inside BLAS would only
/// compete with it. Call before any BLAS work. Throws as above.
inline void blas_single_thread() {
  static const bool done =
      (openblas_set_num_threads(1), require_address_space_of_blas(), map_blas_buffer(), true);
  static_cast<void>(done);
}

inline blasint blas_size(std::size_t n) {
  return static_cast<blasint>(n);
}

}  // namespace flatspeckle
