#include "bench/baselines/gradient_searches.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlopt.h>

namespace flatspeckle::bench {

SearchResult by_adam(const GradientObjective& objective, const SearchLimits& limits,
                     std::vector<double> coefficients, double rate) {
  constexpr double first = 0.9, second = 0.999, least = 1e-12;
  const std::size_t count = coefficients.size();
  std::vector<double> mean(count), square(count);
  double of_mean = 1, of_square = 1;
  for (long traces = 1;; traces += 2) {
    const auto residuals = objective.residuals(coefficients);
    const double loss = residuals ? objective.mean_square(*residuals) : HUGE_VAL;
    if (!(loss > limits.enough) || !residuals || traces >= limits.most_traces)
      return {std::move(coefficients), loss, traces};
    const auto gradient = objective.gradient(*residuals);
    of_mean *= first;
    of_square *= second;
    for (std::size_t i = 0; i < count; ++i) {
      mean[i] += (1 - first) * (gradient[i] - mean[i]);
      square[i] += (1 - second) * (gradient[i] * gradient[i] - square[i]);
      coefficients[i] -=
          rate * (mean[i] / (1 - of_mean)) / (std::sqrt(square[i] / (1 - of_square)) + least);
    }
    limits.bounds.hold(coefficients);
  }
}

namespace {

struct CountedObjective {
  const GradientObjective& objective;
  long traces = 0;
};

/// Returns the loss to minimise; a large finite number if a ray is lost.
double loss_of(unsigned count, const double* at, double* gradient, void* data) {
  constexpr double lost = 1e6;
  CountedObjective& called = *static_cast<CountedObjective*>(data);
  const auto residuals = called.objective.residuals({at, count});
  ++called.traces;
  if (gradient) {
    ++called.traces;
    std::fill_n(gradient, count, 0.0);
    if (residuals) std::ranges::copy(called.objective.gradient(*residuals), gradient);
  }
  return residuals ? called.objective.mean_square(*residuals) : lost;
}

}  // namespace

SearchResult by_lbfgs(const GradientObjective& objective, const SearchLimits& limits,
                      std::vector<double> coefficients) {
  CountedObjective called{objective};
  const auto count = static_cast<unsigned>(coefficients.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(
      nlopt_create(NLOPT_LD_LBFGS, count), nlopt_destroy);
  nlopt_set_min_objective(search.get(), loss_of, &called);
  nlopt_set_lower_bounds(search.get(), limits.bounds.least.data());
  nlopt_set_upper_bounds(search.get(), limits.bounds.most.data());
  nlopt_set_stopval(search.get(), limits.enough);
  nlopt_set_maxeval(search.get(), static_cast<int>(limits.most_traces / 2));
  double loss = HUGE_VAL;
  nlopt_optimize(search.get(), coefficients.data(),
                 &loss);  // the best point so far is kept, whatever the reason for stopping
  return {std::move(coefficients), loss, called.traces};
}

}  // namespace flatspeckle::bench
