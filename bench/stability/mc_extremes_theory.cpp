// Deterministic parts of the Monte Carlo method: diffusion theory, integrals and matrix factors.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/oracles/multiprecision.h"
#include "bench/scenes/standard_scenes.h"
#include "bench/stability/extreme_rows.h"
#include "flatland/media/medium.h"
#include "grin/media/scattering/diffusion_rate.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "mc/paths/estimators/single_scattering.h"
#include "mc/paths/speckle/speckle_field.h"
#include "mc/paths/walk/importance.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::bench {

namespace {

using namespace mc;
using namespace oracles;
using std::numbers::pi;

BulkMedium bulk(double mu_t, double g, double albedo) {
  Scatterer scatterer;
  scatterer.kind = Scatterer::Kind::hg;
  scatterer.g = g;
  scatterer.albedo = albedo;
  return bulk_medium(scatterer, {.density = {}, .g = g, .text = {}}, mu_t);
}

/// Compares with the formulas of C20 evaluated in 50 digits, for a slab of thickness 1.
Finding diffusion_row(double optical_depth, double g, double albedo, double q) {
  const BulkMedium medium = bulk(optical_depth, g, albedo);
  const Wide mu_t(medium.mu_t), mu_s(medium.mu_s), transport = 1 / (mu_t - mu_s * Wide(g));
  const Wide z0 = Wide(0.818) * transport, kappa2 = 2 * (mu_t - mu_s) / transport;
  const auto f = [&](const Wide& square) -> Wide {
    const Wide rate = sqrt(square), deep = 1 + 2 * z0;
    if (rate == 0) return z0 * (transport + z0) / deep;
    return sinh(rate * z0) * sinh(rate * (transport + z0)) / (rate * sinh(rate * deep));
  };
  const Wide exact = f(Wide(q) * q + kappa2) / f(kappa2);
  const double found = diffusion_field_correlation({medium, 1}, q);
  return {static_cast<double>(abs(found / exact - 1)), 1e-9};
}

/// Returns the smallest root of the dispersion relation used in importance.cpp, with moments of the
/// phase function down to 1e-22.
long double decay_rate(long double albedo, long double g) {
  std::vector<long double> moments{1};
  while (moments.back() > 1e-22L) moments.push_back(g * moments.back());
  const auto below = [&](long double rate) {
    const long double s = rate * rate / 4;
    long double tail = (1 + std::sqrt(1 - rate * rate)) / 2;
    for (std::size_t n = moments.size() - 1; n >= 1; --n) {
      tail = 1 - albedo * moments[n] - s / tail;
      if (tail <= 0) return false;
    }
    return 1 - albedo > 2 * s / tail;
  };
  long double low = 0, high = 1;
  for (int step = 0; step < 64; ++step) {
    const long double middle = (low + high) / 2;
    (below(middle) ? low : high) = middle;
  }
  return low;
}

Finding decay_row(double albedo, double g) {
  // for isotropic scattering the albedo is sqrt(1 - rate^2)
  const long double exact = g == 0
                                ? std::sqrt((1 - static_cast<long double>(albedo)) * (1 + albedo))
                                : decay_rate(albedo, g);
  return {static_cast<double>(std::abs(grin::diffusion_rate(albedo, g, 2) / exact - 1)), 1e-9};
}

/// Checks the integral of a plane wave over a box without attenuation, with k L = 1e6 along both
/// sides: sinc functions times the area.
Finding wave_integral(Vec kappa) {
  const double extent = 1e6 / k;
  const Domain domain{Domain::Kind::box, extent, extent};
  const auto found =
      attenuated_wave_integral(domain, 0, kappa, {Vec{0, -1}, {0, 1}, {0, -1}, {0, 1}});
  const auto sinc = [](double a) { return a == 0 ? 1 : std::sin(a) / a; };
  const Complex exact = domain.content() * sinc(kappa.x * extent / 2) * sinc(kappa.z * extent / 2) *
                        std::polar(1.0, kappa.z * extent / 2);
  return {std::abs(found - exact) / std::abs(exact), 1e-6};
}

/// Checks the integral for backscattering, with all four factors along -z: int exp(-2 mu_t z).
Finding backscattering_integral(double optical_depth) {
  const Domain domain{Domain::Kind::box, 20, 10};
  const double mu_t = optical_depth / 10;
  const Vec up{0, -1};
  const double exact = -20 * std::expm1(-2 * optical_depth) / (2 * mu_t);
  return {std::abs(attenuated_wave_integral(domain, mu_t, {0, 0}, {up, up, up, up}) / exact - 1.0),
          1e-9};
}

/// Checks the integral for illumination and detection along the box, at exactly pi/2: the integrand
/// is exp(-mu_t width) everywhere.
Finding grazing_integral() {
  const Domain domain{Domain::Kind::box, 20, 10};
  const Vec w = direction(pi / 2);
  const auto found = attenuated_wave_integral(domain, 0.1, {0, 0}, {-w, w, -w, w});
  return {std::abs(found / (200 * std::exp(-2)) - 1.0), 1e-9};
}

/// Checks the wave of a near endpoint (C13) for k = 1: sqrt(pi k/2) e^{i pi/4} H_0 for k r < 10,
/// and its far-field form beyond.
Finding near_wave_row(double kr) {
  using std::numbers::pi_v;
  const auto [j, y] = bessel_oracle(0, kr);
  const ExtendedComplex h(static_cast<long double>(j), static_cast<long double>(y));
  const ExtendedComplex turn = std::polar(1.0L, pi_v<long double> / 4);
  const long double r = kr;
  const ExtendedComplex exact = kr < 10 ? std::sqrt(pi_v<long double> / 2) * turn * h
                                        : ExtendedComplex(std::cos(r), std::sin(r)) / std::sqrt(r);
  const Complex found = outgoing_wave(1, kr);
  return {static_cast<double>(std::abs(ExtendedComplex(found) - exact) / std::abs(exact)), 1e-14};
}

/// Checks the factor F of the covariance of fully correlated fields in four channels, of magnitude
/// 1e-100, 1, 1e100 and 0: F has rank 1, and F F^H equals the covariance in each channel.
Finding factor_row() {
  const double scale[] = {1e-100, 1, 1e100, 0};
  std::vector<Complex> lower;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b <= a; ++b)
      lower.push_back(scale[a] * scale[b] * std::polar(1.0, a - 1.0 * b));
  const CovarianceFactor factor(4, lower);
  if (factor.rank() != 1) return {static_cast<double>(factor.rank()), 1};
  std::vector<Complex> column(4);
  factor.apply(std::vector<Complex>{1}, column);
  double worst = std::abs(column[3]);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      worst = larger(worst, std::abs(column[a] / scale[a] * std::conj(column[b] / scale[b]) -
                                     std::polar(1.0, a - 1.0 * b)));
  return {worst, 1e-14};
}

void add_diffusion(ExtremeRows& rows) {
  const std::string digits = "C20 in 50 digits";
  rows.add("diffusion, OD 100, albedo 1 - 1e-9, q L = 1", digits, diffusion_row, 100, 0, 1 - 1e-9,
           1);
  rows.add("diffusion, OD 1e4, g 0.999, albedo 1, q L = 1e-9", digits, diffusion_row, 1e4, 0.999, 1,
           1e-9);
  rows.add("diffusion, OD 1e4, albedo 0.01, q L = 1e-3", digits, diffusion_row, 1e4, 0, 0.01, 1e-3);
  rows.add("diffusion, OD 1e4, albedo 1, q L = 600: 1e-257", digits, diffusion_row, 1e4, 0, 1, 600);
  for (const auto& [name, albedo] : {std::pair("1 - 1e-9", 1 - 1e-9), {"0.5", 0.5}, {"1e-9", 1e-9}})
    for (const double g : {0.0, 0.999})
      rows.add("decay rate with depth, albedo " + std::string(name) + ", g " + short_number(g),
               g == 0 ? "sqrt(1 - albedo^2)" : "all moments in long double", decay_row, albedo, g);
}

void add_integrals(ExtremeRows& rows) {
  rows.add("single scattering, k L 1e6, phases across", "sinc", wave_integral, Vec{0.3 * k, 0});
  rows.add("single scattering, k L 1e6, phases in depth", "sinc", wave_integral, Vec{0, -0.7 * k});
  rows.add_each("single scattering straight back, OD ", {1e-12, 1.0, 1e4}, "", "closed form",
                backscattering_integral);
  rows.add("single scattering along a box, exactly pi/2", "exp(-mu_t width) area",
           grazing_integral);
  for (const double kr : {1e-300, 1e-12, 9.999, 1e6, 1e15})
    rows.add("wave of a near end at k r = " + short_number(kr),
             kr < 10 ? "H_0 in 50 digits" : "far form in long double", near_wave_row, kr);
  rows.add("covariance of channels of 1e-100, 1, 1e100, 0, all alike", "rank 1, F F^H = C",
           factor_row);
}

}  // namespace

void mc_theory_extremes(ExtremeRows& rows) {
  add_diffusion(rows);
  add_integrals(rows);
}

}  // namespace flatspeckle::bench
