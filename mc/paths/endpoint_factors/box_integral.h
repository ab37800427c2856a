#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// Computes attenuated_wave_integral() (coherent_field.h) over a box in space. The exponent is a
/// linear function of position in each part of the box from which every ray leaves through one
/// side. These parts are convex bodies; they are divided into tetrahedra, over which the integral
/// of the exponential of a linear function has a closed form. The error is that of rounding, about
/// 1e-14 times the volume, for any kappa. Takes 10 to 300 microseconds.
Complex attenuated_wave_integral_in_space(const Domain& box, Complex mu_t, Vec kappa,
                                          const std::vector<Vec>& towards);

/// Returns the divided difference of exp at four points, which is the integral of exp(l(x)) over a
/// tetrahedron of volume 1/6 at whose corners the linear function l has these values.
Complex divided_difference(const Complex (&points)[4]);

}  // namespace flatspeckle::mc
