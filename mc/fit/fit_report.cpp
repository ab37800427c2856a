#include "mc/fit/fit_report.h"

#include <cmath>

#include "mc/fit/curve_values.h"
#include "mc/fit/derived.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd slopes_at(const FitTask& task, const VectorXd& coordinates) {
  VectorXd slopes = coordinates;
  for (Index i = 0; i < slopes.size(); ++i)
    slopes[i] = task.free[static_cast<std::size_t>(i)].slope(coordinates[i]);
  return slopes;
}

/// Of the first curve's medium.
std::vector<Derived> derived_at(const FitTask& task, const VectorXd& at,
                                const MatrixXd& covariance) {
  const SceneSpec& spec = task.measurements.front().curves.front().scene;
  const auto scene = [&](const VectorXd& x) {
    return scene_of(with_parameters(spec, task.free, x));
  };
  const VectorXd range = upper_coordinates(task.free) - lower_coordinates(task.free);
  const auto rows = static_cast<Index>(derived_rows.size());
  const auto values = [&](const VectorXd& x) {
    const Scene of = scene(x);
    VectorXd found(rows);
    for (Index r = 0; r < rows; ++r) found[r] = derived_rows[static_cast<std::size_t>(r)].value(of);
    return found;
  };
  LeastSquares as_problem{values, {}, lower_coordinates(task.free), upper_coordinates(task.free)};
  const VectorXd here = values(at);
  const MatrixXd slopes = jacobian(as_problem, at, here);
  const VectorXd error = (slopes * covariance * slopes.transpose()).diagonal().cwiseSqrt();
  std::vector<Derived> derived;
  for (Index r = 0; r < rows; ++r) {
    const DerivedRow& row = derived_rows[static_cast<std::size_t>(r)];
    derived.push_back({row.name, row.unit, here[r], error[r]});
  }
  return derived;
}

}  // namespace

VectorXd values_at(const FitTask& task, const VectorXd& coordinates) {
  VectorXd values = coordinates;
  for (Index i = 0; i < values.size(); ++i)
    values[i] = task.free[static_cast<std::size_t>(i)].value(coordinates[i]);
  return values;
}

void put_information(const FitTask& task, const Information& known, const VectorXd& coordinates,
                     MediumFit& fit) {
  fit.estimates = values_at(task, coordinates);
  fit.covariance = covariance_of_values(task, coordinates, known.covariance);
  fit.errors = fit.covariance.diagonal().cwiseSqrt();
  fit.correlation = known.correlation;
  fit.condition = known.condition;
  fit.worst = known.worst;
  const VectorXd range = upper_coordinates(task.free) - lower_coordinates(task.free);
  const VectorXd share = known.errors().cwiseQuotient(range);
  for (const double one : share) fit.known.push_back(one < 0.25);
  fit.derived = derived_at(task, coordinates, known.covariance);
}

MatrixXd covariance_of_values(const FitTask& task, const VectorXd& coordinates,
                              const MatrixXd& covariance) {
  const VectorXd slopes = slopes_at(task, coordinates);
  return slopes.asDiagonal() * covariance * slopes.asDiagonal();
}

bool is_likely(double chi_squared, Index values, Index parameters) {
  const auto degrees = static_cast<double>(values - parameters);
  return chi_squared < degrees + 4 * std::sqrt(2 * degrees) + 4;
}

MatrixXd jacobian(const LeastSquares& problem, const VectorXd& at, const VectorXd& here) {
  constexpr double step = 1e-3;  // of the distance of the bounds
  MatrixXd slopes(here.size(), at.size());
  for (Index i = 0; i < at.size(); ++i) {
    const double range = problem.upper[i] - problem.lower[i],
                 sign = 2 * at[i] > problem.lower[i] + problem.upper[i] ? -1 : 1;
    VectorXd next = at;
    next[i] += sign * step * range;
    slopes.col(i) = (problem.residuals(next) - here) / (next[i] - at[i]);
  }
  return slopes;
}

}  // namespace flatspeckle::mc
