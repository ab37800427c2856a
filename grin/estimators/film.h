#pragma once

#include <span>

#include "core/numbers/complex.h"
#include "grin/estimators/energy_balance.h"

namespace flatspeckle::grin {

/// Equal bins of optical path. What falls before or beyond is kept in the first or last bin, so
/// that the sum over bins is the steady picture.
struct TimeBins {
  double first = 0, last = 0;  ///< edges
  int count = 1;               ///< 1: steady state
};

/// Sums of a batch: [pixel][bin].
class Film {
 public:
  Film(int pixels, const TimeBins& bins, std::span<Complex> sums);

  /// A contribution is shared between the two bins whose centres are next to it (linear splat),
  /// which keeps its mean optical path between the first and the last centre.
  void add(int pixel, double value, double optical_path) {
    // bin centres are the whole numbers
    const double at = (optical_path - first_) * bins_per_length_ - 0.5;
    Complex* const bin = sums_.data() + static_cast<std::size_t>(pixel) * count_;
    if (!(at > 0)) {
      bin[0] += value;
    } else if (at >= count_ - 1) {
      bin[count_ - 1] += value;
    } else {
      const int before = static_cast<int>(at);
      const double later = value * (at - before);
      bin[before] += value - later;
      bin[before + 1] += later;
    }
  }
  /// Steady state.
  void add(int pixel, double value) { sums_[static_cast<std::size_t>(pixel) * count_] += value; }

  EnergyBalance energy;  ///< of light paths that are walked to their ends

 private:
  std::span<Complex> sums_;
  int count_;
  double first_, bins_per_length_;
};

}  // namespace flatspeckle::grin
