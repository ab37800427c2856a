#pragma once

#include <vector>

#include "core/numbers/scaled.h"

namespace flatspeckle {

/// J_n(x) for n = 0 .. order at any order; x > 0. As accurate as bessel_j.
std::vector<ScaledReal> scaled_bessel_j(int order, double x);

/// H_n(x) of the first kind for n = 0 .. order at any order; x > 0. As accurate as hankel.
std::vector<ScaledComplex> scaled_hankel(int order, double x);

}  // namespace flatspeckle
