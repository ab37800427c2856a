#include "grin/media/scattering/mie_phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle::grin {

namespace {

/// Returns the order n beyond which the ratio psi_n / xi_n of Riccati-Bessel functions is below
/// rounding at the argument `size`.
int last_order(double size) {
  return static_cast<int>(size + 8 * std::cbrt(size)) + 12;
}

/// Returns the ratios psi_{n+1}(z) / psi_n(z) of Riccati-Bessel functions, n = 0 .. last, by
/// downward recurrence. The ratio equals (n + 1)/z minus the logarithmic derivative of psi_n.
std::vector<Complex> psi_ratios(Complex z, int last) {
  std::vector<Complex> ratios(static_cast<std::size_t>(last) + 1);
  Complex ratio = 0;
  for (int n = std::max(last, last_order(std::abs(z))) + 1; n > 0; --n) {
    ratio = 1.0 / ((2.0 * n + 1) / z - ratio);
    if (n - 1 <= last) ratios[static_cast<std::size_t>(n) - 1] = ratio;
  }
  return ratios;
}

/// Returns the Riccati-Bessel functions psi_n(x) = x j_n(x), n = 0 .. last, by Miller's algorithm
/// with the normalisation sum (2 n + 1) j_n^2 = 1.
std::vector<double> psi(double x, int last) {
  constexpr double large = 1e100;
  const int start = std::max(last, last_order(x)) + 12;
  std::vector<double> f(static_cast<std::size_t>(start) + 1);
  double above = 0, here = f.back() = 1 / large;
  for (int n = start; n > 0; --n) {
    above = std::exchange(here, (2.0 * n + 1) / x * here - above);
    f[static_cast<std::size_t>(n) - 1] = here;
    if (std::abs(here) < large) continue;
    for (double* value : {&above, &here}) *value /= large;
    for (auto i = static_cast<std::size_t>(n) - 1; i < f.size(); ++i) f[i] /= large;
  }
  double squares = 0;
  for (std::size_t n = 0; n < f.size(); ++n)
    squares += (2 * static_cast<double>(n) + 1) * f[n] * f[n];
  const double j0 = std::sin(x) / x, j1 = (j0 - std::cos(x)) / x,
               sign = std::abs(f[0]) > std::abs(f[1]) ? f[0] * j0 : f[1] * j1,
               scale = std::copysign(x / std::sqrt(squares), sign);
  f.resize(static_cast<std::size_t>(last) + 1);
  for (double& value : f) value *= scale;
  return f;
}

/// Returns xi_n(x) = x h_n(x), where h_n is the spherical Hankel function of outgoing waves, by
/// upward recurrence.
std::vector<Complex> xi(double x, const std::vector<double>& psi) {
  std::vector<Complex> values;
  double before = std::sin(x), eta = -std::cos(x);  // x y_{-1}, x y_0
  for (std::size_t n = 0; n < psi.size(); ++n) {
    values.emplace_back(psi[n], eta);
    before = std::exchange(eta, (2 * static_cast<double>(n) + 1) / x * eta - before);
  }
  return values;
}

using std::numbers::pi;

/// Returns the coefficients of cos(k angle), k = 0 .. degree, of a polynomial f of the cosine.
template <typename F>
std::vector<double> cosine_modes(const F& f, std::size_t degree) {
  const std::size_t steps = degree + 1;
  std::vector<double> cosines, modes(degree + 1);
  for (std::size_t i = 0; i < 2 * steps; ++i)
    cosines.push_back(std::cos(pi * static_cast<double>(i) / static_cast<double>(steps)));
  for (std::size_t j = 0; j <= steps; ++j) {
    const double share = (j == 0 || j == steps ? 1.0 : 2.0) / static_cast<double>(steps),
                 value = share * f(cosines[j]);
    for (std::size_t k = 0; k <= degree; ++k) modes[k] += value * cosines[k * j % (2 * steps)];
  }
  modes[0] /= 2;
  return modes;
}

/// Returns the Fourier modes of the integral of 2 pi p sin from 0 to an angle, for a phase function
/// p with the given modes. This integral equals sum_m modes[m] (1 - cos(m angle)).
std::vector<double> integral_modes(const std::vector<double>& p) {
  const auto at = [&](std::size_t k) { return k < p.size() ? p[k] : 0; };
  std::vector<double> modes = {0, pi * (2 * at(0) - at(2))};
  for (std::size_t m = 2; m <= p.size(); ++m)
    modes.push_back(pi * (at(m - 1) - at(m + 1)) / static_cast<double>(m));
  return modes;
}

double unpolarized(const MieSphere& sphere, double cosine) {
  const auto [s1, s2] = sphere.amplitudes(cosine);
  return (std::norm(s1) + std::norm(s2)) /
         (2 * pi * sphere.size() * sphere.size() * sphere.scattering());
}

}  // namespace

MieSphere::MieSphere(double size, Complex index)
    : size_(size), index_(index), coefficients_(coefficients()) {
  const auto magnitude = [](const Coefficients& c) { return std::abs(c.a) + std::abs(c.b); };
  constexpr double rounding = 1e-18;
  double largest_one = 0;
  for (const Coefficients& c : coefficients_) largest_one = std::max(largest_one, magnitude(c));
  while (!coefficients_.empty() && magnitude(coefficients_.back()) <= rounding * largest_one)
    coefficients_.pop_back();
  sum();
}

/// Returns a_n and b_n for the size parameter x and the relative index m, with r_n = psi_{n+1}(mx)
/// / psi_n(mx):
///   a_n = (((n + 1)/x (m - 1/m) + r_n) psi_n - m psi_{n+1}) / (the same with xi for psi),
///   b_n = (m r_n psi_n - psi_{n+1}) / (the same with xi for psi).
std::vector<MieSphere::Coefficients> MieSphere::coefficients() const {
  if (index_ == 1.0) return {};
  const int last = last_order(size_);
  const auto inside = psi_ratios(index_ * size_, last);
  const auto regular = psi(size_, last + 1);
  const auto leaving = xi(size_, regular);
  std::vector<Coefficients> list;
  for (int n = 1; n <= last; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const Complex of_a = (n + 1) / size_ * (index_ - 1.0 / index_) + inside[i],
                  of_b = index_ * inside[i];
    list.push_back({(of_a * regular[i] - index_ * regular[i + 1]) /
                        (of_a * leaving[i] - index_ * leaving[i + 1]),
                    (of_b * regular[i] - regular[i + 1]) / (of_b * leaving[i] - leaving[i + 1])});
  }
  return list;
}

void MieSphere::sum() {
  double extinction = 0, scattering = 0, cosine = 0;
  for (std::size_t i = 0; i < coefficients_.size(); ++i) {
    const auto& [a, b] = coefficients_[i];
    const double n = static_cast<double>(i + 1);
    extinction += (2 * n + 1) * (a + b).real();
    scattering += (2 * n + 1) * (std::norm(a) + std::norm(b));
    cosine += (2 * n + 1) / (n * (n + 1)) * (a * std::conj(b)).real();
    if (i + 1 == coefficients_.size()) continue;
    const auto& next = coefficients_[i + 1];
    cosine += n * (n + 2) / (n + 1) * (a * std::conj(next.a) + b * std::conj(next.b)).real();
  }
  const double scale = 2 / (size_ * size_);
  extinction_ = scale * extinction;
  scattering_ = scale * scattering;
  if (scattering > 0) mean_cosine_ = 2 * cosine / scattering;
}

MieSphere::Amplitudes MieSphere::amplitudes(double cosine) const {
  Amplitudes found{};
  double before = 0, pi_n = 1;  // Legendre functions P_k^1 / sin for k = n - 1 and k = n
  for (std::size_t i = 0; i < coefficients_.size(); ++i) {
    const auto& [a, b] = coefficients_[i];
    const double n = static_cast<double>(i + 1), tau = n * cosine * pi_n - (n + 1) * before,
                 share = (2 * n + 1) / (n * (n + 1));
    found.s1 += share * (a * pi_n + b * tau);
    found.s2 += share * (a * tau + b * pi_n);
    before = std::exchange(pi_n, ((2 * n + 1) * cosine * pi_n - (n + 1) * before) / n);
  }
  return found;
}

MiePhase::MiePhase(const MieSphere& sphere) {
  Shape shape{sphere, {}, {0}};
  const auto degree = 2 * static_cast<std::size_t>(sphere.order());
  shape.integral = integral_modes(
      cosine_modes([&](double cosine) { return unpolarized(sphere, cosine); }, degree));
  const std::size_t steps = 2 * degree;
  for (std::size_t i = 1; i <= steps; ++i)
    shape.so_far.push_back(
        std::max(shape.so_far.back(),
                 up_to(shape, pi * static_cast<double>(i) / static_cast<double>(steps))));
  shape_ = std::make_shared<const Shape>(std::move(shape));
}

/// Returns the integral of the phase function from 0 to the angle, by Clenshaw's recurrence.
double MiePhase::up_to(const Shape& shape, double angle) {
  const double twice = 2 * std::cos(angle);
  double sum = 0, later = 0, all = 0;
  for (auto mode = shape.integral.rbegin(); mode != shape.integral.rend(); ++mode) {
    all += *mode;
    sum = std::exchange(later, *mode + twice * later - sum);
  }
  return all - (later - twice / 2 * sum);
}

double MiePhase::density(double cosine) const {
  return unpolarized(shape_->sphere, cosine);
}

/// Samples an interval of the table so_far, then finds the angle in this interval by Newton's
/// method.
double MiePhase::one_minus_cosine(RandomStream& random) const {
  constexpr int most = 60;
  constexpr double close = 1e-13;
  const auto& so_far = shape_->so_far;
  const double target = random.uniform() * so_far.back(),
               step = pi / static_cast<double>(so_far.size() - 1);
  const auto above = std::upper_bound(so_far.begin() + 1, so_far.end() - 1, target);
  double high = step * static_cast<double>(above - so_far.begin()), low = high - step,
         angle = low + step / 2;
  for (int i = 0; i < most; ++i) {
    const double miss = up_to(*shape_, angle) - target;
    (miss > 0 ? high : low) = angle;
    const double newton = angle - miss / (2 * pi * std::sin(angle) * density(std::cos(angle)));
    const double next = newton > low && newton < high ? newton : (low + high) / 2;
    if (std::abs(std::exchange(angle, next) - next) < close) break;
  }
  return 2 * std::sin(angle / 2) * std::sin(angle / 2);
}

MiePhase make_phase(const Keys& keys, const MiePhaseValues& values) {
  const std::string name = keys.name(values.sphere_index),
                    &text = keys.required(values.sphere_index);
  const Complex index = parse_complex(name, text);
  if (index == 0.0 || index.real() < 0 || index.imag() < 0)
    throw InputError(name, text, "must not be 0, negative or amplifying (Im >= 0 absorbs)");
  const MieSphere sphere(keys.required(values.size_parameter), index);
  if (!(sphere.scattering() > 0))
    throw InputError(name, text, "must differ from 1: the sphere does not scatter");
  return MiePhase(sphere);
}

}  // namespace flatspeckle::grin
