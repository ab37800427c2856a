#pragma once

#include "grin/design/descent/least_squares.h"

namespace flatspeckle::bench {

using GradientObjective = grin::design::Objective;

/// Where a search ended, and how often each ray was traced for it, forward or backward.
struct Searched {
  std::vector<double> coefficients;
  double loss;
  long traces;
};

/// When a search ends, and the bounds that it keeps to.
struct SearchLimits {
  grin::design::Bounds bounds;
  double enough;  ///< loss
  long most_traces;
};

// Searches by the gradient of the loss alone, to compare least squares with.

/// Steps of Adam (Kingma and Ba 2015), by which a coefficient changes by about `rate`.
Searched by_adam(const GradientObjective& objective, const SearchLimits& limits,
                 std::vector<double> coefficients, double rate);

/// L-BFGS (Nocedal 1980), by NLopt.
Searched by_lbfgs(const GradientObjective& objective, const SearchLimits& limits,
                  std::vector<double> coefficients);

}  // namespace flatspeckle::bench
