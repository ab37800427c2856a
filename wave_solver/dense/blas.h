#pragma once

// The BLAS and LAPACK that the room uses, with C++ complex numbers.

#include <complex>

#include <cblas.h>

#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <lapacke.h>

namespace flatspeckle::wave {

/// Parallelism is ours, over realizations, boxes or columns: threads inside BLAS would only compete
/// with it. Call before any BLAS work.
inline void blas_single_thread() {
  static const bool done = (openblas_set_num_threads(1), true);
  static_cast<void>(done);
}

}  // namespace flatspeckle::wave
