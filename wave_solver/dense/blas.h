#pragma once

// Products and triangular solves of complex column-major matrices with leading dimensions.

#include "core/numbers/blas.h"

namespace flatspeckle::wave {

/// Replaces C by alpha op(A) op(B) + beta C. op(A) is rows x inner, C is rows x columns.
inline void multiply(CBLAS_TRANSPOSE op_a, CBLAS_TRANSPOSE op_b, std::size_t rows,
                     std::size_t columns, std::size_t inner, std::complex<double> alpha,
                     const std::complex<double>* a, std::size_t lda, const std::complex<double>* b,
                     std::size_t ldb, std::complex<double> beta, std::complex<double>* c,
                     std::size_t ldc) {
  cblas_zgemm(CblasColMajor, op_a, op_b, blas_size(rows), blas_size(columns), blas_size(inner),
              &alpha, a, blas_size(lda), b, blas_size(ldb), &beta, c, blas_size(ldc));
}

/// Replaces X by op(T)^-1 X (side: left) or X op(T)^-1 (side: right). T is triangular, X is rows x
/// columns.
inline void triangular_solve(CBLAS_SIDE side, CBLAS_UPLO triangle, CBLAS_TRANSPOSE op,
                             std::size_t rows, std::size_t columns, const std::complex<double>* t,
                             std::size_t ldt, std::complex<double>* x, std::size_t ldx) {
  const std::complex<double> one = 1;
  cblas_ztrsm(CblasColMajor, side, triangle, op, CblasNonUnit, blas_size(rows), blas_size(columns),
              &one, t, blas_size(ldt), x, blas_size(ldx));
}

/// Subtracts W W^T from the lower triangle of C. W is n x depth; W and C have the same leading
/// dimension.
inline void subtract_square(std::size_t n, std::size_t depth, const std::complex<double>* w,
                            std::complex<double>* c, std::size_t ld) {
  const std::complex<double> one = 1, minus_one = -1;
  cblas_zsyrk(CblasColMajor, CblasLower, CblasNoTrans, blas_size(n), blas_size(depth), &minus_one,
              w, blas_size(ld), &one, c, blas_size(ld));
}

/// Subtracts V W^T from C by three real products instead of four. Errors of C are small relative to
/// |V| |W|, but not separately for the real and the imaginary part [higham1992]. C is rows x
/// columns; C, V and W have the same leading dimension.
inline void subtract_product(std::size_t rows, std::size_t columns, std::size_t depth,
                             const std::complex<double>* v, const std::complex<double>* w,
                             std::complex<double>* c, std::size_t ld) {
  const std::complex<double> one = 1, minus_one = -1;
  cblas_zgemm3m(CblasColMajor, CblasNoTrans, CblasTrans, blas_size(rows), blas_size(columns),
                blas_size(depth), &minus_one, v, blas_size(ld), w, blas_size(ld), &one, c,
                blas_size(ld));
}

}  // namespace flatspeckle::wave
