#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Whether coherent_field() applies to a scene: a box of scatterers with a T-matrix, with plane
/// waves and far views.
bool has_coherent_field(const Scene& scene);

/// Returns the mean far field per channel (C15). Every scatterer scatters the coherent wave, with
/// amplitude A from the direction w_i of the light to the direction w_v of the view. The coherent
/// wave has travelled a length d inside the medium, with wavenumber k_eff instead of k:
///   rho A(i->v) int dx exp(i k (w_i - w_v).x + i (k_eff - k) d(x, -w_i)).
/// In space the amplitude is that of C57.
/// Neglects reflection and diffraction at the edges of the box, like the whole Monte Carlo method.
std::vector<Complex> coherent_field(const Scene& scene);

/// Computes int dx exp(i kappa.x - mu_t/2 sum_j d(x, u_j)) over a box, or over the depth of a slab
/// at x = 0. Here d(x, u_j) is the distance from x to the edge along the unit vector u_j =
/// towards[j], of which there are at most four. In the plane the integral is exact in z; in x it is
/// computed by Gauss-Legendre quadrature between the kinks of the integrand, with an error of about
/// 1e-9 times the area. A box in space has a closed form (box_integral.h). If the wavenumber in the
/// medium is k + k_shift, the caller adds -2 i k_shift to mu_t.
Complex attenuated_wave_integral(const Domain& domain, Complex mu_t, Vec kappa,
                                 const std::vector<Vec>& towards);

}  // namespace flatspeckle::mc
