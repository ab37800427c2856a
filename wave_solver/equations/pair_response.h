#pragma once

#include <vector>

#include "core/numbers/scaled.h"

namespace flatspeckle::wave {

/// What two scatterers by themselves make of plane waves: for the first one and n = 0 .. order, the
/// largest |beta_n|, the coefficient of sigma psi_n (TMatrixSystem), over directions of the light.
/// By reciprocity, leaving out order n changes far fields by about |beta_n|^2. t_first, t_second:
/// T_n up to the orders to be solved for. Empty where no solution is found.
std::vector<double> pair_response(const std::vector<ScaledComplex>& t_first,
                                  const std::vector<ScaledComplex>& t_second, double k,
                                  double distance);

}  // namespace flatspeckle::wave
