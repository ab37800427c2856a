#include "grin/media/fields/ultrasound.h"

#include <algorithm>

namespace flatspeckle::grin {

StandingWave::StandingWave(double background, double amplitude, int m, double kr, double reach)
    : background_(background),
      amplitude_(amplitude),
      kr_(kr),
      m_(m),
      profile_(std::make_shared<const BesselProfile>(m, kr * reach)) {}

/// Of g(u) Re z^m: 2 g' (delta_ij h + x_i h_j + h_i x_j) + 4 g'' x_i x_j h + g h_ij, where u =
/// |z|^2, h = Re z^m is harmonic, and Bessel's equation gives 4 u g'' = -4 (m + 1) g' - g.
IndexHessian StandingWave::angular_hessian(const Vec3& x) const {
  const double a = kr_ * x[0], b = kr_ * x[1], u = a * a + b * b;
  const auto at = profile_->bent_jet(u);
  const double value = at.value, slope = at.slope, bend = at.bend;
  const std::complex<double> h = power(x, m_);
  const std::complex<double> h1 = double(m_) * power(x, m_ - 1);
  const std::complex<double> h2 = m_ > 1 ? double(m_ * (m_ - 1)) * power(x, m_ - 2) : 0;
  const double hx = h1.real(), hy = -h1.imag();
  const double scale = amplitude_ * kr_ * kr_, diagonal = 2 * slope * h.real();
  const double curved = 4 * bend * h.real();
  Mat3 hessian = Mat3::Zero();
  hessian(0, 0) = diagonal + 4 * slope * a * hx + curved * a * a + value * h2.real();
  hessian(1, 1) = diagonal + 4 * slope * b * hy + curved * b * b - value * h2.real();
  hessian(0, 1) = 2 * slope * (a * hy + b * hx) + curved * a * b - value * h2.imag();
  hessian(1, 0) = hessian(0, 1);
  const Vec3 gradient(2 * slope * a * h.real() + value * hx, 2 * slope * b * h.real() + value * hy,
                      0);
  return {background_ + amplitude_ * value * h.real(), amplitude_ * kr_ * gradient,
          scale * hessian};
}

void add_keys(Keys& keys, UltrasoundValues& values) {
  add_keys(keys, static_cast<SoundValues&>(values));
  keys.add("sound_order", values.sound_order, "m of J_m(k rho) cos(m phi)")
      .from(0, BesselProfile::max_order);
}

StandingWave make_field(const Keys& keys, const UltrasoundValues& values, const FieldUse& use) {
  constexpr double longest_table = 1e3;  // in k rho; beyond it the wave is slow, not wrong
  const double k = wavenumber_of(keys, values, use);
  return at_phase(StandingWave(background(keys, values.index, use), amplitude_of(keys, values),
                               static_cast<int>(keys.read(values.sound_order)), k,
                               std::min(use.reach, longest_table / k)),
                  phase_of(keys, values, use));
}

}  // namespace flatspeckle::grin
