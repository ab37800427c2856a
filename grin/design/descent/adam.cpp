#include "grin/design/descent/adam.h"

#include <cmath>

#include "grin/design/system/vectors.h"

namespace flatspeckle::grin::design {

/// A state's memory: means of gradients and of their squares, and the number of steps.
SearchStep Adam::advance(SearchState& state) {
  constexpr double first = 0.9, second = 0.999, least = 1e-12;
  const std::size_t count = state.coefficients.size();
  if (state.memory.empty() || state.memory[0].size() != count)
    state.memory = {Numbers(count, 0.0), Numbers(count, 0.0), Numbers(1, 0.0)};
  const auto residuals = objective_.residuals(state.coefficients);
  if (!residuals) return SearchStep::stalled;
  const Numbers gradient = objective_.gradient(*residuals);
  Numbers &mean = state.memory[0], &square = state.memory[1];
  const double steps = ++state.memory[2][0];
  const double of_mean = 1 - std::pow(first, steps), of_square = 1 - std::pow(second, steps);
  for (std::size_t i = 0; i < count; ++i) {
    mean[i] = first * mean[i] + (1 - first) * gradient[i];
    square[i] = second * square[i] + (1 - second) * gradient[i] * gradient[i];
    state.coefficients[i] -=
        search_.rate * (mean[i] / of_mean) / (std::sqrt(square[i] / of_square) + least);
  }
  search_.bounds.hold(state.coefficients);
  state.loss = objective_.loss(state.coefficients);
  state.traces += 2;
  return std::isfinite(state.loss) ? SearchStep::better : SearchStep::stalled;
}

}  // namespace flatspeckle::grin::design
