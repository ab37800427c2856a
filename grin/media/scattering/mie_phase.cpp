#include "grin/media/scattering/mie_phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

/// Of cos(k angle), k = 0 .. degree, of a polynomial of the cosine.
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

/// Of 2 pi int p sin from 0 to an angle, as sum_m modes[m] (1 - cos(m angle)).
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

/// By Clenshaw's recurrence.
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

/// Newton's method within the step that is drawn.
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
    throw InputError(name, text, "must not be 0, nor negative, nor amplify (Im >= 0 absorbs)");
  const MieSphere sphere(keys.required(values.size_parameter), index);
  if (!(sphere.scattering() > 0)) throw InputError(name, text, "does not scatter");
  return MiePhase(sphere);
}

}  // namespace flatspeckle::grin
