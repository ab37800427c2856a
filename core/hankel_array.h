#pragma once

#include <span>

#include "core/complex.h"

namespace flatspeckle {

// Hankel functions of the first kind for arrays of real arguments x > 0, vectorised.

/// h[i] = H_0(x[i]), relative error 1e-15.
void hankel0(std::span<const double> x, std::span<Complex> h);

/// H_n(x_i) for n = 0 .. order at re[n * x.size() + i], im[n * x.size() + i]; error below 1e-14 of
/// |H_n|, so that the real part, J_n, is lost where |Y_n| is large: it is set to 0 where it would
/// not show in |H_n|. Y_n beyond the range of double is -inf.
void hankel_sets(std::span<const double> x, int order, double* re, double* im);

}  // namespace flatspeckle
