#pragma once

#include "grin/design/descent/least_squares.h"

namespace flatspeckle::bench {

using GradientObjective = grin::design::Objective;

/// Result of a search. `traces` counts how often each ray was traced, forward or backward.
struct SearchResult {
  std::vector<double> coefficients;
  double loss;
  long traces;
};

/// Stopping criteria of a search, and the bounds of the coefficients.
struct SearchLimits {
  grin::design::Bounds bounds;
  double enough;  ///< loss at which the search stops
  long most_traces;
};

// Baselines for the least-squares design: searches that use only the gradient of the loss.

/// Minimises by Adam (Kingma and Ba 2015). Each step changes a coefficient by about `rate`.
SearchResult by_adam(const GradientObjective& objective, const SearchLimits& limits,
                     std::vector<double> coefficients, double rate);

/// Minimises by L-BFGS (Nocedal 1980), as implemented in NLopt.
SearchResult by_lbfgs(const GradientObjective& objective, const SearchLimits& limits,
                      std::vector<double> coefficients);

}  // namespace flatspeckle::bench
