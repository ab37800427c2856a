#pragma once

#include <span>

#include "core/complex.h"

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

  /// A contribution is shared between the two bins whose centres are next to it (linear splat).
  void add(int pixel, double value, double optical_path);
  void add(int pixel, double value);  ///< steady state
};

}  // namespace flatspeckle::grin
