#include "grin/media/scattering/slow_mode.h"

#include "grin/media/scattering/diffusion_rate.h"

namespace flatspeckle::grin {

SlowMode::SlowMode(double albedo, double g)
    : kappa_(diffusion_rate(albedo, g, 3)), g_(g), drift_(1 / (1 - g)) {
  constexpr int most = 1000;
  constexpr double negligible = 1e-14;
  std::vector<double> ratio(most + 2);  // psi_l / psi_(l-1), downwards
  for (int l = most; l >= 1; --l)
    ratio[l] = kappa_ * l /
               ((2 * l + 1) * (1 - albedo * std::pow(g, l)) - kappa_ * (l + 1) * ratio[l + 1]);
  double moment = 1;
  for (int l = 0; l <= most; ++l) {
    if (l > 0) moment *= ratio[l] * g;
    series_.push_back((2 * l + 1) * moment);
    if (std::abs(series_.back()) < negligible) break;
  }
}

}  // namespace flatspeckle::grin
