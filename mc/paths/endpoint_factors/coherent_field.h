#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// A box of scatterers with a T-matrix in plane waves, seen in far views: then the mean field has a
/// closed form here.
bool has_coherent_field(const Scene& scene);

/// Mean far field per channel (C15): every scatterer radiates A under the coherent wave that has
/// travelled the length d inside the medium with k_eff instead of k,
///   rho A(i->v) int dx exp(i k (w_i - w_v).x + i (k_eff - k) d(x, -w_i)).
/// Neglects reflection and diffraction at the box's edges, like all of the Monte Carlo method.
std::vector<Complex> coherent_field(const Scene& scene);

/// int dx exp(i kappa.x - mu_t/2 sum_j d(x, u_j)) over a box, or over the depth of a slab at x = 0,
/// where d is the distance to the edge along a unit vector, of which there are at most four: exact
/// in depth, by Gauss-Legendre quadrature across, cut where the integrand has kinks. Relative to
/// the area about 1e-9. mu_t is complex where the wavenumber in the medium is another: -2 i
/// k_shift.
Complex attenuated_wave_integral(const Domain& domain, Complex mu_t, Vec2 kappa,
                                 const std::vector<Vec2>& towards);

}  // namespace flatspeckle::mc
