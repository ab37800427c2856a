#include "grin/design/descent/objective.h"

#include <cmath>
#include <utility>

#include "core/error.h"

namespace flatspeckle::grin::design {

std::optional<std::vector<double>> Objective::residuals(
    std::span<const double> coefficients) const {
  const auto readings = rays_.trace(form_, coefficients);
  if (!readings) return std::nullopt;
  return goal_.residuals(*readings);
}

double Objective::mean_square(std::span<const double> residuals) const {
  double sum = 0;
  for (const double r : residuals) sum += r * r;
  return sum / static_cast<double>(rays_.rays());
}

double Objective::loss(std::span<const double> coefficients) const {
  const auto found = residuals(coefficients);
  return found ? mean_square(*found) : HUGE_VAL;
}

std::vector<double> Objective::gradient(std::span<const double> residuals) const {
  std::vector<double> by_readings = goal_.transposed(residuals);
  for (double& by : by_readings) by *= 2 / static_cast<double>(rays_.rays());
  return rays_.gradient(by_readings);
}

SearchState begin_search(const Objective& objective, const Search& search,
                         std::vector<double> coefficients) {
  const auto residuals = objective.residuals(coefficients);
  if (!residuals) throw InputError("start", "field", "a ray does not come to its end in it");
  SearchState state{std::move(coefficients)};
  state.damping = search.first_damping;
  state.loss = objective.mean_square(*residuals);
  state.traces = 1;
  return state;
}

}  // namespace flatspeckle::grin::design
