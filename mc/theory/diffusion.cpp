#include "mc/theory/diffusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/log_sinh.h"

namespace flatspeckle::mc {

double extrapolation_length(const BulkMedium& medium) {
  return (medium.dimension == 3 ? 0.7104 : 0.818) * medium.transport_mean_free_path();
}

Complex diffusion_loss_correlation(const BulkMedium& medium, double thickness, Complex loss) {
  const double transport_length = medium.transport_mean_free_path();
  const double source = std::min(transport_length, thickness),
               extrapolation = extrapolation_length(medium);
  const double mu_a = medium.mu_t - medium.mu_s;
  const double kappa2 = medium.dimension * mu_a / transport_length;
  // Returns log f of C20. Q is set to at least 1e-5 / thickness; below this value f equals its
  // limit at Q = 0 to rounding.
  const auto log_f = [&](Complex q2) {
    const Complex root = std::sqrt(q2), least = 1e-5 / thickness,
                  rate = std::abs(root) > least.real() ? root : least;
    return log_sinh(rate * extrapolation) + log_sinh(rate * (source + extrapolation)) -
           std::log(rate) - log_sinh(rate * (thickness + 2 * extrapolation));
  };
  return std::exp(log_f(loss + kappa2) - log_f(kappa2));
}

double diffusion_field_correlation(const BulkMedium& medium, double thickness, double q) {
  return diffusion_loss_correlation(medium, thickness, q * q).real();
}

double diffusion_range(const BulkMedium& medium, double thickness) {
  const auto above = [&](double q) {
    return std::pow(diffusion_field_correlation(medium, thickness, q), 2) > 0.5;
  };
  double low = 0, high = 1 / thickness;
  while (above(high)) high *= 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (above(middle) ? low : high) = middle;
  }
  return (low + high) / 2;
}

double scatterings_of_slowest_mode(const BulkMedium& medium, const Domain& domain) {
  const double beyond = 2 * extrapolation_length(medium),
               diffusion = medium.transport_mean_free_path() / medium.dimension;
  // Rate, per length of path, at which light leaves through two opposite edges
  const auto leaving = [&](double extent) {
    const double wavenumber = std::numbers::pi / (extent + beyond);
    return diffusion * wavenumber * wavenumber;
  };
  const double sides = domain.kind == Domain::Kind::box ? leaving(domain.width) : 0;
  return medium.mu_s / (medium.mu_t - medium.mu_s + leaving(domain.depth) + sides);
}

double single_scattering_correlation(double light, const std::vector<double>& views,
                                     double thickness, double q) {
  Complex sum = 0;
  for (double view : views) {
    const double phase = q * thickness * (std::tan(view) - std::tan(light)) / 2;
    sum += std::polar(1.0, phase) * (phase == 0 ? 1 : std::sin(phase) / phase);
  }
  return std::abs(sum) / static_cast<double>(views.size());
}

}  // namespace flatspeckle::mc
