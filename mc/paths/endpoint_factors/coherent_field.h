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

}  // namespace flatspeckle::mc
