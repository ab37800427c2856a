#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// int dx exp(i kappa.x - mu_t/2 sum_j d(x, u_j)) over a box, or over the depth of a slab at x = 0,
/// where d is the distance to the edge along a unit vector, of which there are at most four: exact
/// in depth, by Gauss-Legendre quadrature across, cut where the integrand has kinks. Relative to
/// the area about 1e-9. mu_t is complex where the wavenumber in the medium is another: -2 i
/// k_shift.
Complex attenuated_wave_integral(const Domain& domain, Complex mu_t, Vec2 kappa,
                                 const std::vector<Vec2>& towards);

}  // namespace flatspeckle::mc
