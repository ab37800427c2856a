#pragma once

#include <span>

#include "core/numbers/complex.h"

namespace flatspeckle {

// Hankel functions of the first kind for arrays of real arguments, positive normal numbers of
// double, vectorised. Beyond 2^23 they take as long as the cos and sin of libm.

/// h[i] = H_0(x[i]), error below 1e-15 of |H_0|.
void hankel0(std::span<const double> x, std::span<Complex> h);

/// H_n(x_i) for n = 0 .. order at re[n * x.size() + i], im[n * x.size() + i], error below
/// (1 + n / 8) 1e-15 of |H_n|. Hence J_n alone is lost where |Y_n| is large; it is 0 where
/// |Y_n| > 1e8, which does not show in |H_n|. Y_n beyond the range of double is -inf.
void hankel_sets(std::span<const double> x, int order, double* re, double* im);

}  // namespace flatspeckle
