#include "wave_solver/equations/rim_waves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/bessel.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle::wave {

namespace {

ExtendedComplex interior_wavenumber(const TMatrixSystem& system, std::size_t disk) {
  return ExtendedComplex(system.placement()[disk].scatterer.index) *
         static_cast<long double>(system.k());
}

// Returns J_n(z) e^{iz} for n = 0 .. order and Im z >= 0, without overflow. Ratios of consecutive
// orders give the J_n up to a factor, which follows from e^{-iz} = J_0 + 2 sum_{n > 0} (-i)^n J_n.
std::vector<ExtendedComplex> scaled_bessel(int order, ExtendedComplex z) {
  std::vector<ExtendedComplex> j(order + 1, 0);
  j[0] = 1;
  if (z == 0.0L) return j;
  const long double size = std::abs(z);
  const int last = std::max(order, static_cast<int>(size + 9 * std::cbrt(size)) + 12);
  const auto ratios = bessel_ratios(last, z);
  ExtendedComplex value = 1, sum = 1, power = 2;
  for (int n = 1; n <= last; ++n) {
    value = product(value, ratios[n - 1]);
    power = {power.imag(), -power.real()};
    sum += product(power, value);
    if (n <= order) j[n] = value;
  }
  for (auto& value_n : j) value_n /= sum;
  return j;
}

// Returns cos(n phi) + i sin(n phi) for n = 0 .. order, with phi the angle of the vector d and r
// its length. If r = 0, phi is taken as 0.
std::vector<Complex> turns(int order, Vec d, double r) {
  const Complex turn = r > 0 ? Complex(d.z, d.x) / r : Complex(1);
  std::vector<Complex> phases(order + 1, 1);
  for (int n = 1; n <= order; ++n) phases[n] = product(phases[n - 1], turn);
  return phases;
}

}  // namespace

bool is_transparent(const TMatrixSystem& system, std::size_t scatterer) {
  const auto t = system.t_matrix(scatterer);
  return std::all_of(t.begin(), t.end(), [](const ExtendedComplex& t_n) { return t_n == 0.0L; });
}

void field_inside(const TMatrixSystem& system, std::size_t disk, std::span<const Vec> points,
                  Target out) {
  const auto& [centre, cylinder] = system.placement()[disk];
  const ModeSet modes = system.modes(disk);
  const ExtendedComplex mk = interior_wavenumber(system, disk);
  const ExtendedComplex rim = mk * static_cast<long double>(cylinder.radius);
  const auto at_rim = scaled_bessel(modes.order, rim);
  auto waves = rim_waves(cylinder, system.k(), modes.order);
  for (int n = 0; n <= modes.order; ++n) waves[n].field /= at_rim[n];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec d = points[i] - centre;
    const double r = length(d);
    const ExtendedComplex z = mk * static_cast<long double>(r);
    const ExtendedComplex growth = std::exp(product(ExtendedComplex(0, 1), rim - z));
    auto here = scaled_bessel(modes.order, z);
    for (int n = 0; n <= modes.order; ++n)
      here[n] = product(product(here[n], waves[n].field), growth);
    const auto phases = turns(modes.order, d, r);
    for (std::size_t column = 0; column < modes.modes.size(); ++column) {
      const auto [n, odd, weight] = modes.modes[column];
      const double angular = odd ? phases[n].imag() : phases[n].real();
      out.data[out.ld * column + i] =
          (n == 0 ? 1 : std::numbers::sqrt2) * angular * Complex(here[n]);
    }
  }
}

std::vector<RimWave> rim_waves(const Scatterer& cylinder, double k, int order, Radial kind) {
  const double x = k * cylinder.radius;
  const ExtendedComplex m(cylinder.index), mx = m * static_cast<long double>(x);
  const ExtendedComplex q = cylinder.kind == Scatterer::Kind::tm ? m : 1.0L / m;
  const auto t = scaled_t_matrix(cylinder, k, order, kind);
  const auto h = scaled_hankel(order + 1, x, kind);
  const auto ratios = bessel_ratios(order, mx, kind);
  const long double size = kind == Radial::spherical ? x : std::numbers::pi_v<long double> / 2;
  const ScaledComplex wronskian(ExtendedComplex(0, -1 / (size * x)));
  std::vector<RimWave> waves(order + 1);
  for (int n = 0; n <= order; ++n) {
    if (t[n].value() == 0.0L) continue;
    const ExtendedComplex derivative = q * (static_cast<long double>(n) / mx - ratios[n]);
    const ScaledComplex denominator = derivative * h[n] - cylinder_derivative(h, n, x);
    waves[n].field =
        static_cast<ExtendedComplex>(sqrt(abs(t[n])) / t[n] * (wronskian / denominator));
    waves[n].derivative = derivative * waves[n].field;
  }
  return waves;
}

}  // namespace flatspeckle::wave
