#pragma once

#include <cstddef>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle::wave {

/// Returns the number of real spherical harmonics of degrees 0 .. order.
inline std::size_t harmonics_up_to(int order) {
  return static_cast<std::size_t>(order + 1) * static_cast<std::size_t>(order + 1);
}

/// Returns the index of the harmonic that contains cos(m phi) or, if `odd`, sin(m phi). Harmonics
/// run over the degrees l and, within each, over m = 0, cos(phi), sin(phi), cos(2 phi), ..
inline std::size_t harmonic_index(int l, int m, bool odd = false) {
  return static_cast<std::size_t>(l * l + (m == 0 ? 0 : 2 * m - 1 + (odd ? 1 : 0)));
}

/// Real orthonormal spherical harmonics (C60)
///   R_l0 = N_l0(cos theta),  R_lm = N_lm(cos theta) {cos, sin}(m phi),
/// with the polar angle theta from +z and the azimuth phi from x towards y. The recurrences over l
/// are those of fully normalised associated Legendre functions.
class Harmonics {
 public:
  explicit Harmonics(int order);

  int order() const { return order_; }
  /// Returns all harmonics of a direction, which must be a unit vector.
  std::vector<double> at(Vec w) const;

  // N_mm = sin^m(theta) diagonal(m), and N_lm = rise(l, m) (cos(theta) N_(l-1)m - fall(l, m)
  // N_(l-2)m) for l > m, where N_(m-1)m = 0.
  double diagonal(int m) const { return diagonal_[m]; }
  double rise(int l, int m) const { return rise_[at(l, m)]; }
  double fall(int l, int m) const { return fall_[at(l, m)]; }

 private:
  static std::size_t at(int l, int m) { return static_cast<std::size_t>(l * (l + 1) / 2 + m); }

  int order_;
  std::vector<double> diagonal_, rise_, fall_;
};

}  // namespace flatspeckle::wave
