#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Held while FFTW plans, or forgets a plan: it does neither for two threads at a time.
std::mutex& fourier_planning();

/// In-place transform of one contiguous line, sum_j x_j exp(-+ 2 pi i j m / size), without factor.
/// Plans are estimated, not timed, so that a result does not depend on the machine's mood. Safe to
/// make and to use from several threads.
class LineTransform {
 public:
  enum class Direction { forward, backward };
  LineTransform(std::size_t size, Direction direction);
  void operator()(Complex* line) const;

 private:
  struct Plan;
  std::shared_ptr<const Plan> plan_;
};

/// Transform of an even function on a periodic grid of rows x columns, given and returned on its
/// first (rows / 2 + 1) x (columns / 2 + 1) points.
void transform_even(std::vector<Complex>& values, std::size_t rows, std::size_t columns);

/// Smallest even 2^a 3^b 5^c from `least` on.
std::size_t transform_size(double least);

}  // namespace flatspeckle
