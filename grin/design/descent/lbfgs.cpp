#include "grin/design/descent/lbfgs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grin/design/system/vectors.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::size_t most_pairs = 10;

// A state's memory: change of coefficients and of gradient, pair after pair, oldest first; then the
// gradient.

/// Minus the inverse Hessian that the pairs tell, times a gradient (two loops).
Numbers direction(const std::vector<Numbers>& memory, Numbers gradient) {
  const std::size_t pairs = memory.size() / 2;
  Numbers factors(pairs);
  for (std::size_t p = pairs; p-- > 0;) {
    const Numbers &s = memory[2 * p], &y = memory[2 * p + 1];
    factors[p] = dot(s, gradient) / dot(s, y);
    add(gradient, -factors[p], y);
  }
  double scale = 1;
  if (pairs > 0) {
    const Numbers &s = memory[2 * pairs - 2], &y = memory[2 * pairs - 1];
    scale = dot(s, y) / dot(y, y);
  }
  for (double& g : gradient) g *= scale;
  for (std::size_t p = 0; p < pairs; ++p) {
    const Numbers &s = memory[2 * p], &y = memory[2 * p + 1];
    add(gradient, factors[p] - dot(y, gradient) / dot(s, y), s);
  }
  for (double& g : gradient) g = -g;
  return gradient;
}

/// 0 where a step would cross a bound at once.
void hold(const Bounds& bounds, const Numbers& at, Numbers& gradient) {
  for (std::size_t i = 0; i < at.size(); ++i)
    if ((at[i] <= bounds.least[i] && gradient[i] > 0) ||
        (at[i] >= bounds.most[i] && gradient[i] < 0))
      gradient[i] = 0;
}

void remember(std::vector<Numbers>& memory, const Numbers& step, const Numbers& change) {
  if (!(dot(step, change) > 1e-12 * std::sqrt(dot(step, step) * dot(change, change)))) return;
  if (memory.size() == 2 * most_pairs) memory.erase(memory.begin(), memory.begin() + 2);
  memory.push_back(step);
  memory.push_back(change);
}

/// A first step, of which no pair tells the length, changes coefficients by a hundredth at most.
double first_length(const std::vector<Numbers>& memory, const Numbers& along) {
  if (!memory.empty()) return 1;
  double most = 0;
  for (const double a : along) most = std::max(most, std::abs(a));
  return most > 0 ? 0.01 / most : 1;
}

}  // namespace

/// From the last step, or anew at the start of a level.
Numbers Lbfgs::gradient_at(SearchState& state) const {
  auto& memory = state.memory;
  if (memory.empty() || memory.back().size() != state.coefficients.size()) {
    memory.clear();
    ++state.traces;
    return objective_.gradient(*objective_.residuals(state.coefficients));
  }
  Numbers gradient = std::move(memory.back());
  memory.pop_back();
  return gradient;
}

SearchStep Lbfgs::advance(SearchState& state) {
  Numbers gradient = gradient_at(state), held = gradient;
  hold(search_.bounds, state.coefficients, held);
  Numbers along = direction(state.memory, held);
  if (!(dot(along, held) < 0)) {
    state.memory.clear();
    along = direction({}, held);
  }
  constexpr int most_trials = 20;
  constexpr double enough = 1e-4;
  double length = first_length(state.memory, along);
  for (int trial = 0; trial < most_trials; ++trial, length /= 3) {
    Numbers next = state.coefficients;
    add(next, length, along);
    search_.bounds.hold(next);
    const auto residuals = objective_.residuals(next);
    ++state.traces;
    const double loss = residuals ? objective_.mean_square(*residuals) : HUGE_VAL;
    if (!(loss <= state.loss + enough * length * dot(along, held))) continue;
    Numbers after = objective_.gradient(*residuals), step = next, change = after;
    ++state.traces;
    add(step, -1, state.coefficients);
    add(change, -1, gradient);
    remember(state.memory, step, change);
    state.memory.push_back(std::move(after));
    state.coefficients = std::move(next);
    state.loss = loss;
    return SearchStep::better;
  }
  state.memory.push_back(std::move(gradient));
  return SearchStep::settled;
}

}  // namespace flatspeckle::grin::design
