#pragma once

#include <cstddef>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// A = L L^T of a complex symmetric (not Hermitian) matrix without pivoting: half the work of LU,
/// nearly all of it in rank-k updates. Meant for matrices whose real part is positive semidefinite,
/// as those of passive scatterers are (TMatrixSystem): every Schur complement is of that kind
/// again, so that no pivot vanishes. Element growth is bounded only where the real part is well
/// conditioned (Golub and Van Loan 1979); callers check a residual.
///
/// a: column-major with leading dimension ld; its lower triangle becomes L, the strict upper one is
/// left alone. False if a pivot is 0 or not finite.
bool factor_symmetric(Complex* a, std::size_t n, std::size_t ld);

/// X <- L^-1 X, X column-major of n rows.
void solve_forward(const Complex* l, std::size_t n, std::size_t ld, Complex* x, std::size_t columns,
                   std::size_t ldx);
/// X <- L^-T X
void solve_backward(const Complex* l, std::size_t n, std::size_t ld, Complex* x,
                    std::size_t columns, std::size_t ldx);

}  // namespace flatspeckle::wave
