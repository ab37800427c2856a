#include "wave_solver/equations/rim_waves.h"

#include <numbers>

#include "core/numbers/bessel.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle::wave {

std::vector<RimWave> rim_waves(const Scatterer& cylinder, double k, int order) {
  const double x = k * cylinder.radius;
  const ExtendedComplex m(cylinder.index), mx = m * static_cast<long double>(x);
  const ExtendedComplex q = cylinder.kind == Scatterer::Kind::tm ? m : 1.0L / m;
  const auto t = scaled_t_matrix(cylinder, k, order);
  const auto h = scaled_hankel(order + 1, x);
  const auto ratios = bessel_ratios(order, mx);
  const ScaledComplex wronskian(ExtendedComplex(0, -2 / (std::numbers::pi_v<long double> * x)));
  std::vector<RimWave> waves(order + 1);
  for (int n = 0; n <= order; ++n) {
    if (t[n].value() == 0.0L) continue;
    const ExtendedComplex slope = q * (static_cast<long double>(n) / mx - ratios[n]);
    const ScaledComplex denominator = slope * h[n] - cylinder_derivative(h, n, x);
    waves[n].field =
        static_cast<ExtendedComplex>(sqrt(abs(t[n])) / t[n] * (wronskian / denominator));
    waves[n].slope = slope * waves[n].field;
  }
  return waves;
}

}  // namespace flatspeckle::wave
