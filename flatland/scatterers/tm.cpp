#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

// Returns T_n of C7 or, for spheres, C57. With the derivatives J_n'(mx) = (n/(mx) - r_n) J_n(mx),
// r_n = J_{n+1}(mx)/J_n(mx), and the corresponding ones outside, it becomes
//   T_n = -(J_{n+1} - m r_n J_n) / (H_{n+1} - m r_n H_n).
// This avoids the terms n/x, which would cancel for small or weak cylinders.
std::vector<ScaledComplex> tm_t_matrix(const Scatterer& cylinder, double x, int order,
                                       Radial kind) {
  std::vector<ScaledComplex> t(order + 1);
  if (cylinder.index == 1.0) return t;
  const ExtendedComplex m(cylinder.index);
  const auto ratios = bessel_ratios(order, m * static_cast<long double>(x), kind);
  const auto j = scaled_bessel_j(order + 1, x, kind);
  const auto h = scaled_hankel(order + 1, x, kind);
  for (int n = 0; n <= order; ++n) {
    const ExtendedComplex inside = m * ratios[n];
    t[n] = -(j[n + 1] - inside * j[n]) / (h[n + 1] - inside * h[n]);
  }
  return t;
}

}  // namespace

const ScattererKind tm_kind{"tm", Scatterer::Kind::tm, read_radius_and_index, tm_t_matrix};
const ScattererKind penetrable_kind{"penetrable", Scatterer::Kind::tm, read_radius_and_index,
                                    tm_t_matrix};

}  // namespace flatspeckle
