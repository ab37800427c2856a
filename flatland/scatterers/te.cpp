#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

// Returns T_n of C7, transformed as in tm.cpp (m: index, r_n: ratio of Bessel functions defined
// there):
//   T_n = -(s J_n + J_{n+1}) / (s H_n + H_{n+1}),  s = (n/x)(1/m^2 - 1) - r_n / m.
// In the numerator the leading terms of J_{n+1}/J_n and r_n/m are both x/(2(n+1)) and cancel. They
// are removed by the recurrence J_{n+1} = x/(2(n+1)) (J_n + J_{n+2}), which is applied outside and
// inside the cylinder.
std::vector<ScaledComplex> te_t_matrix(const Scatterer& cylinder, double x, int order, Radial) {
  std::vector<ScaledComplex> t(order + 1);
  if (cylinder.index == 1.0) return t;
  const ExtendedComplex m(cylinder.index);
  const auto ratios = bessel_ratios(order + 1, m * static_cast<long double>(x));
  const auto j = scaled_bessel_j(order + 2, x);
  const auto h = scaled_hankel(order + 1, x);
  for (int n = 0; n <= order; ++n) {
    const long double leading = static_cast<long double>(x) / (2 * (n + 1));
    const ExtendedComplex jump =
        static_cast<long double>(n) / x * (1.0L - m) * (1.0L + m) / (m * m);
    const ScaledComplex numerator =
        (jump - leading * ratios[n] * ratios[n + 1]) * j[n] + leading * j[n + 2];
    t[n] = -numerator / ((jump - ratios[n] / m) * h[n] + h[n + 1]);
  }
  return t;
}

}  // namespace

const ScattererKind te_kind{"te", Scatterer::Kind::te, read_radius_and_index, te_t_matrix};

}  // namespace flatspeckle
