#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

// Returns T_n of C7 or C57: the normal derivative of the field is 0 at the rim.
std::vector<ScaledComplex> hard_t_matrix(const Scatterer&, double x, int order, Radial kind) {
  const auto j = scaled_bessel_j(order + 1, x, kind);
  const auto h = scaled_hankel(order + 1, x, kind);
  std::vector<ScaledComplex> t(order + 1);
  for (int n = 0; n <= order; ++n)
    t[n] = -cylinder_derivative(j, n, x) / cylinder_derivative(h, n, x);
  return t;
}

}  // namespace

const ScattererKind hard_kind{"hard", Scatterer::Kind::hard, read_radius, hard_t_matrix};

}  // namespace flatspeckle
