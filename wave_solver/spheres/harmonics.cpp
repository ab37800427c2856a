#include "wave_solver/spheres/harmonics.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::wave {

Harmonics::Harmonics(int order) : order_(order), rise_(at(order + 1, 0)), fall_(at(order + 1, 0)) {
  long double top = std::sqrt(1 / (4 * std::numbers::pi_v<long double>));
  for (int m = 0; m <= order; ++m) {
    // Functions with m > 0 are larger by sqrt(2), because cos^2 and sin^2 have the mean 1/2.
    if (m > 0) top *= std::sqrt((m == 1 ? 2.0L : 1.0L) * (2 * m + 1) / (2 * m));
    diagonal_.push_back(static_cast<double>(top));
    for (int l = m + 1; l <= order; ++l) {
      const long double square = static_cast<long double>(l) * l,
                        before = static_cast<long double>(l - 1) * (l - 1),
                        own = static_cast<long double>(m) * m;
      rise_[at(l, m)] = static_cast<double>(std::sqrt((4 * square - 1) / (square - own)));
      fall_[at(l, m)] = static_cast<double>(std::sqrt((before - own) / (4 * before - 1)));
    }
  }
}

std::vector<double> Harmonics::at(Vec w) const {
  std::vector<double> values(harmonics_up_to(order_));
  double cosine = 1, sine = 0;  // sin^m(theta) cos(m phi), sin^m(theta) sin(m phi)
  for (int m = 0; m <= order_; ++m) {
    double before = 0, here = diagonal_[m];
    for (int l = m; l <= order_; ++l) {
      if (l > m) {
        const double next = rise(l, m) * (w.z * here - fall(l, m) * before);
        before = here;
        here = next;
      }
      values[harmonic_index(l, m)] = here * cosine;
      if (m > 0) values[harmonic_index(l, m, true)] = here * sine;
    }
    const double turned = cosine * w.x - sine * w.y;
    sine = cosine * w.y + sine * w.x;
    cosine = turned;
  }
  return values;
}

}  // namespace flatspeckle::wave
