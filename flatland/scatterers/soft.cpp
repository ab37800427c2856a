#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

// Returns T_n of C7 or C57: the field is 0 at the rim.
std::vector<ScaledComplex> soft_t_matrix(const Scatterer&, double x, int order, Radial kind) {
  const auto j = scaled_bessel_j(order + 1, x, kind);
  const auto h = scaled_hankel(order + 1, x, kind);
  std::vector<ScaledComplex> t(order + 1);
  for (int n = 0; n <= order; ++n) t[n] = -j[n] / h[n];
  return t;
}

}  // namespace

const ScattererKind soft_kind{"soft", Scatterer::Kind::soft, read_radius, soft_t_matrix};

}  // namespace flatspeckle
