#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "wave_solver/spheres/harmonics.h"

namespace flatspeckle::wave {

/// Angular factors of the translation of spherical waves (C61): integrals of three harmonics,
/// computed once for all pairs of spheres. The translation of the wave (l', m') to (l, m) is a sum
/// over waves of degree L and order M about the sender, for M = |m - m'| and M = m + m'.
class SphereTranslations {
 public:
  /// The factors of one M. They are values[i] for L = first, first + 2, ..; `count` of them.
  struct Sum {
    const double* values = nullptr;
    int first = 0, count = 0;
  };

  /// order: largest degree of the waves that are translated.
  explicit SphereTranslations(int order);

  int order() const { return harmonics_.order() / 2; }
  /// Harmonics up to twice the order.
  const Harmonics& harmonics() const { return harmonics_; }
  /// Returns the factors for M = |m - m'| (sum = false) or M = m + m' (sum = true).
  Sum factors(int l, int m, int other_l, int other_m, bool sum) const {
    const std::size_t number = 2 * (row(l, m) * rows_ + row(other_l, other_m)) + (sum ? 1 : 0);
    return {values_.data() + start_[number], first_[number],
            static_cast<int>(start_[number + 1] - start_[number])};
  }

 private:
  static std::size_t row(int l, int m) { return static_cast<std::size_t>(l * (l + 1) / 2 + m); }

  Harmonics harmonics_;
  std::size_t rows_;
  std::vector<double> values_;
  std::vector<std::size_t> start_;
  std::vector<int> first_;
};

/// Returns the translations of waves up to at least this order. They are computed once and kept.
std::shared_ptr<const SphereTranslations> sphere_translations(int order);

}  // namespace flatspeckle::wave
