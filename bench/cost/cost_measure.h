#pragma once

#include <functional>
#include <string>

#include "bench/cost/cost_curve.h"

namespace flatspeckle::bench {

/// A work whose size doubles from `smallest` to `largest`.
struct Scaling {
  std::string what, size_name;
  double smallest, largest;
  double expected;  ///< exponent
  /// Prepares the work of a size; what it returns is timed, and may be called again.
  std::function<std::function<void()>(double size)> work;
};

/// CPU seconds of each size, medians of rounds in turn; sizes that would not end in time are left
/// out. The exponent is that of the four largest.
CostCurve measure_cost(const Scaling& scaling, double cpu_seconds);

/// The exponent of the four largest sizes, its error from the scatter about the line.
void fit_exponent(CostCurve& curve);

}  // namespace flatspeckle::bench
