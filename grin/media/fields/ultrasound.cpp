#include "grin/media/fields/ultrasound.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <mutex>
#include <numbers>

#include "core/error.h"
#include "core/numbers/bessel.h"

namespace flatspeckle::grin {

namespace {

/// Returns g_m(x^2) = J_m(x) / x^m for the order m and x > 0 (BesselProfile).
long double profile(int order, double x) {
  return bessel_j(order, x)[order] / std::pow(static_cast<long double>(x), order);
}

}  // namespace

BesselProfile::BesselProfile(int order, double reach)
    : order_(order), reach_(reach), cells_(std::ceil(reach * cells_per_unit)) {
  assert(order >= 0 && order <= max_order);
  if (!(reach > 0 && reach <= 1e4))
    throw InputError("reach of the sound wave in radians", reach, "must be from 0 to 1e4");
  table_ = table_of(order, static_cast<std::size_t>(cells_) + 1);
}

/// Returns a table of at least `cells` polynomials for this order. The longest table made so far is
/// kept for each order; it is extended if it is too short.
std::shared_ptr<const BesselProfile::Table> BesselProfile::table_of(int order, std::size_t cells) {
  static std::mutex mutex;
  static std::array<std::shared_ptr<const Table>, max_order + 1> longest;
  const std::lock_guard lock(mutex);
  auto& made = longest[static_cast<std::size_t>(order)];
  if (made && made->size() >= cells) return made;
  auto longer = std::make_shared<Table>(made ? *made : Table());
  while (longer->size() < cells) longer->push_back(fit(order, static_cast<double>(longer->size())));
  return made = longer;
}

/// Returns the polynomial of a cell: interpolates g_m in Chebyshev nodes by Newton's formula and
/// expands the result in powers of u - centre(cell).
BesselProfile::Cell BesselProfile::fit(int order, double cell) {
  constexpr int count = degree + 1;
  const long double middle = centre(cell);
  const long double half = std::max(cell + 0.25, 0.5) / (cells_per_unit * cells_per_unit);
  std::array<long double, count> t, f;
  for (int i = 0; i < count; ++i) {
    const long double node = std::cos(std::numbers::pi_v<long double> * (i + 0.5L) / count);
    // The interpolation nodes t and values f are computed from this rounded x
    const double x = static_cast<double>(std::sqrt(middle + half * node));
    t[i] = (static_cast<long double>(x) * x - middle) / half;
    f[i] = profile(order, x);
  }
  for (int level = 1; level < count; ++level)
    for (int i = count - 1; i >= level; --i) f[i] = (f[i] - f[i - 1]) / (t[i] - t[i - level]);
  std::array<long double, count> power{};
  for (int i = count - 1; i >= 0; --i) {
    for (int k = degree; k > 0; --k) power[k] = power[k - 1] - t[i] * power[k];
    power[0] = f[i] - t[i] * power[0];
  }
  Cell result;
  for (int k = 0; k < count; ++k) result.c[k] = static_cast<double>(power[k] / std::pow(half, k));
  return result;
}

/// Computes jet(u) beyond the table, from the Bessel functions of the C library; exact to rounding.
BesselProfile::Jet BesselProfile::far_jet(double u) const {
  const double x = std::sqrt(u);
  if (!std::isfinite(x)) return {u, u};
  const double scale = std::pow(x, -order_);
  return {::jn(order_, x) * scale, -::jn(order_ + 1, x) * scale / (2 * x)};
}

StandingWave::StandingWave(double background, double amplitude, int m, double kr, double reach)
    : background_(background),
      amplitude_(amplitude),
      kr_(kr),
      m_(m),
      profile_(std::make_shared<const BesselProfile>(m, kr * reach)) {}

/// The Hessian of g(u) Re z^m is 2 g' (delta_ij h + x_i h_j + h_i x_j) + 4 g'' x_i x_j h + g h_ij,
/// where u = |z|^2, h = Re z^m is harmonic and indices of h denote its derivatives.
IndexHessian StandingWave::angular_hessian(const Vec3& x) const {
  const double a = kr_ * x[0], b = kr_ * x[1], u = a * a + b * b;
  const auto at = profile_->second_order_jet(u);
  const double value = at.value, derivative = at.derivative,
               second_derivative = at.second_derivative;
  const std::complex<double> h = power(x, m_);
  const std::complex<double> h1 = double(m_) * power(x, m_ - 1);
  const std::complex<double> h2 = m_ > 1 ? double(m_ * (m_ - 1)) * power(x, m_ - 2) : 0;
  const double hx = h1.real(), hy = -h1.imag();
  const double scale = amplitude_ * kr_ * kr_, diagonal = 2 * derivative * h.real();
  const double curved = 4 * second_derivative * h.real();
  Mat3 hessian = Mat3::Zero();
  hessian(0, 0) = diagonal + 4 * derivative * a * hx + curved * a * a + value * h2.real();
  hessian(1, 1) = diagonal + 4 * derivative * b * hy + curved * b * b - value * h2.real();
  hessian(0, 1) = 2 * derivative * (a * hy + b * hx) + curved * a * b - value * h2.imag();
  hessian(1, 0) = hessian(0, 1);
  const Vec3 gradient(2 * derivative * a * h.real() + value * hx,
                      2 * derivative * b * h.real() + value * hy, 0);
  return {background_ + amplitude_ * value * h.real(), amplitude_ * kr_ * gradient,
          scale * hessian};
}

void add_keys(Keys& keys, UltrasoundValues& values) {
  add_keys(keys, static_cast<SoundValues&>(values));
  keys.add("sound_order", values.sound_order, "Order m of the sound J_m(k rho) cos(m phi)")
      .from(0, BesselProfile::max_order);
}

StandingWave make_field(const Keys& keys, const UltrasoundValues& values, const FieldUse& use) {
  // Largest argument kr rho of the Bessel function in the table; beyond, evaluation is slow but
  // correct.
  constexpr double longest_table = 1e3;
  const double k = wavenumber_of(keys, values, use);
  return at_phase(StandingWave(background(keys, values.index, use), amplitude_of(keys, values),
                               static_cast<int>(keys.read(values.sound_order)), k,
                               std::min(use.reach, longest_table / k)),
                  phase_of(keys, values, use));
}

}  // namespace flatspeckle::grin
