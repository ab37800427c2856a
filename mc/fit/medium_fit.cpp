#include "mc/fit/medium_fit.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/search/profile.h"
#include "mc/fit/model/slab_model.h"
#include "mc/fit/task/curve_values.h"
#include "mc/fit/task/fit_data.h"

namespace flatspeckle::mc {

namespace {

/// A quantity that is derived from the properties of a medium.
struct DerivedRow {
  const char *name, *unit;
  double (*value)(const Medium&);
  bool of_motion = false;
};

const std::vector<DerivedRow> derived_rows = {
    {"reduced_scattering", "1/length",
     [](const Medium& of) { return of.scene.medium.mu_s * (1 - of.scene.medium.g); }},
    {"mu_t", "1/length", [](const Medium& of) { return of.scene.medium.mu_t; }},
    {"mu_s", "1/length", [](const Medium& of) { return of.scene.medium.mu_s; }},
    {"mu_a", "1/length",
     [](const Medium& of) { return of.scene.medium.mu_t - of.scene.medium.mu_s; }},
    {"g", "1", [](const Medium& of) { return of.scene.medium.g; }},
    {"albedo", "1", [](const Medium& of) { return of.scene.medium.albedo; }},
    {"transport_mean_free_path", "length",
     [](const Medium& of) { return of.scene.medium.transport_mean_free_path(); }},
    {"diffusion_constant", "length^2 per unit of the delays",
     [](const Medium& of) { return of.spec.diffusion / (of.scene.k * of.scene.k); }, true}};

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Applies a member function of FreeParameter, such as value(), to the coordinate of each
/// parameter.
VectorXd of_each_parameter(const FitTask& task, const VectorXd& coordinates,
                           double (FreeParameter::*function)(double) const) {
  VectorXd found = coordinates;
  for (Index i = 0; i < found.size(); ++i)
    found[i] = (task.free[static_cast<std::size_t>(i)].*function)(coordinates[i]);
  return found;
}

std::vector<DerivedRow> rows_of(const FitTask& task) {
  std::vector<DerivedRow> rows;
  for (const DerivedRow& row : derived_rows)
    if (!row.of_motion || task.moving()) rows.push_back(row);
  return rows;
}

/// Returns the values of the derived quantities of the medium of the first curve.
VectorXd derived_values(const FitTask& task, const std::vector<DerivedRow>& rows,
                        const VectorXd& at) {
  const MovingSpec& spec = task.measurements.front().curves.front().scene;
  const Medium of(with_parameters(spec, task.free, at));
  VectorXd found(std::ssize(rows));
  for (Index r = 0; r < found.size(); ++r) found[r] = rows[static_cast<std::size_t>(r)].value(of);
  return found;
}

std::vector<Derived> derived_at(const FitTask& task, const VectorXd& at,
                                const MatrixXd& covariance) {
  const std::vector<DerivedRow> rows = rows_of(task);
  const auto count = std::ssize(rows);
  const auto values = [&](const VectorXd& x) { return derived_values(task, rows, x); };
  BoundedLeastSquares as_problem = bounds_of(task.free);
  as_problem.residuals = values;
  const VectorXd here = values(at);
  const MatrixXd derivatives = jacobian(as_problem, at, here);
  const VectorXd error =
      (derivatives * covariance * derivatives.transpose()).diagonal().cwiseSqrt();
  std::vector<Derived> derived;
  for (Index r = 0; r < count; ++r) {
    const DerivedRow& row = rows[static_cast<std::size_t>(r)];
    derived.push_back({row.name, row.unit, here[r], std::abs(error[r])});
  }
  return derived;
}

using Eigen::Index;
using Eigen::VectorXd;

/// Returns the step of finite differences, relative to the distance of the bounds. Light at
/// distances is computed to nearly full precision, and its derivatives by mu_a and mu_s are so
/// similar that they must be accurate.
double step_of(const FitTask& task) {
  return task.at_distances() ? 3e-5 : 1e-3;
}

/// Returns which values are positive powers at distances, which range over decades.
std::vector<bool> powers_of(const FitTask& task, const FitData& data) {
  std::vector<bool> found;
  for (const Curve& curve : curves_of(task))
    for (std::size_t i = 0; i < curve.entries.size(); ++i) {
      const double value = data.values()[std::ssize(found)];
      found.push_back(curve.distances && curve.observable == Observable::reflectance && value > 0);
    }
  return found;
}

/// Returns the problem with which the search begins if there are such powers: their residuals are
/// differences of logarithms. Far from the best medium, chi^2 itself is nearly constant.
BoundedLeastSquares logarithmic_problem(const FitTask& task, const SlabModel& model,
                                        const FitData& data, const std::vector<bool>& is_power) {
  BoundedLeastSquares problem = bounds_of(task.free);
  problem.residuals = [&](const VectorXd& at) {
    constexpr double least = 1e-300;
    VectorXd found = model.values(media_at(task, at));
    task.report();
    for (Index i = 0; i < found.size(); ++i) {
      const double value = data.values()[i], error = data.errors()[i];
      found[i] = is_power[static_cast<std::size_t>(i)]
                     ? value / error * std::log(std::max(found[i], least) / value)
                     : (found[i] - value) / error;
    }
    return found;
  };
  problem.jacobian = [&task, values = problem](const VectorXd& at, const VectorXd& here) {
    return jacobian(values, at, here, step_of(task));
  };
  return problem;
}

BoundedLeastSquares problem_of(const FitTask& task, const SlabModel& model, const FitData& data) {
  BoundedLeastSquares problem = bounds_of(task.free);
  problem.residuals = [&](const VectorXd& at) -> VectorXd {
    const VectorXd found = data.residuals(model.values(media_at(task, at)));
    task.report(found.squaredNorm());
    return found;
  };
  problem.jacobian = [&task, values = problem](const VectorXd& at, const VectorXd& here) {
    return jacobian(values, at, here, step_of(task));
  };
  return problem;
}

/// Throws InputError if the modelled covariance of the fields is so small that it or its square
/// underflows to 0. The likelihood is then not defined.
void require_light(const VectorXd& covariance) {
  constexpr double least = 1e-140;
  if (!(covariance.cwiseAbs().maxCoeff() > least))
    throw InputError(
        "measurement: if all free keys are in the middle of their ranges, no light reaches the "
        "detection directions of the patterns; choose ranges in which the medium is thinner or "
        "absorbs less");
}

/// Returns the expected chi^2 of the whitened residuals. The values vary with the covariance
/// FitData::scatter(), but are whitened by the shrunk covariance.
double degrees_of_freedom(const LeastSquaresFit& fit, const FitData& data) {
  return expected_chi_squared(data.whitened(data.whitened(data.scatter()).transpose()),
                              fit.jacobian);
}

/// Fits with as many ordinates as necessary. The first search uses the number of ordinates that
/// gives a precision of a thousandth of the values. If the errors of the measurements require a
/// higher precision, a second search follows with more ordinates. Only the best start is used,
/// unless its fit is unlikely (is_likely()).
LeastSquaresFit refined_fit(const FitTask& task, const BoundedLeastSquares& problem,
                            SlabModel& model, const FitData& data, MediumFit& fit) {
  constexpr double share = 0.05, tolerance = 1e-3, rough = 1e-3, rough_end = 1;
  const VectorXd at_first = data.errors().cwiseMax(rough * data.values().cwiseAbs());
  const auto report = [&] { task.report(); };
  model.refine(media_at(task, middle(task)), at_first, share, report);
  const auto is_power = powers_of(task, data);
  std::vector<VectorXd> starts;
  if (std::ranges::count(is_power, true) > 0) {
    const auto begin = logarithmic_problem(task, model, data, is_power);
    const VectorXd start = best_starts(begin, grid_of_starts(task), 1).front();
    starts = {levenberg_marquardt(begin, start, task.most_iterations, rough_end).parameters};
  } else {
    starts = best_starts(problem, grid_of_starts(task), 3);
  }
  LeastSquaresFit best =
      levenberg_marquardt(problem, starts.front(), task.most_iterations, tolerance);
  if (!(best.converged && is_likely(best.chi_squared(), degrees_of_freedom(best, data))))
    best = best_fit(problem, starts, task.most_iterations, tolerance);
  const auto before = model.resolution();
  fit.numerical = model.refine(media_at(task, best.parameters), data.errors(), share, report);
  if (model.resolution() == before) return best;
  auto trace = std::move(best.trace);
  best = levenberg_marquardt(problem, best.parameters, task.most_iterations, tolerance);
  trace.insert(trace.end(), best.trace.begin(), best.trace.end());
  best.trace = std::move(trace);
  return best;
}

/// Maximises the likelihood of measured fields. The least-squares fit is repeated, each time with
/// the errors that follow from the best medium so far, until this medium no longer changes.
LeastSquaresFit likeliest_fit(const FitTask& task, const BoundedLeastSquares& problem,
                              const SlabModel& model, LeastSquaresFit best, FitData& data) {
  constexpr int most = 20;
  constexpr double still = 1e-4,
                   tolerance = 1e-6;  // still: squared length of a step, in standard errors
  for (int i = 0; i < most; ++i) {
    data = data.about(model.values(media_at(task, best.parameters)));
    LeastSquaresFit next =
        levenberg_marquardt(problem, best.parameters, task.most_iterations, tolerance);
    const VectorXd step = next.parameters - best.parameters;
    next.trace.insert(next.trace.begin(), best.trace.begin(), best.trace.end());
    best = std::move(next);
    if ((best.jacobian * step).squaredNorm() < still) return best;
  }
  best.converged = false;
  return best;
}

/// Sets the intervals of the parameters and of the derived quantities.
void put_intervals(const FitTask& task, const BoundedLeastSquares& problem,
                   const LeastSquaresFit& best, MediumFit& fit) {
  constexpr double unlike = 0.3;  // relative difference from two standard errors
  const auto rows = rows_of(task);
  const double errors = std::sqrt(interval_rise);
  fit.low = fit.high = fit.estimates;
  for (Derived& one : fit.derived) one.low = one.high = one.value;
  const VectorXd error = information(problem, best.jacobian).errors();
  for (Index i = 0; i < best.parameters.size(); ++i)
    for (const double side : {-1.0, 1.0}) {
      const VectorXd end = profile_end(problem, best, i, side, interval_rise);
      (side < 0 ? fit.low : fit.high)[i] = values_at(task, end)[i];
      const double distance = std::abs(end[i] - best.parameters[i]);
      if (std::abs(distance - errors * error[i]) > unlike * errors * error[i])
        fit.is_quadratic = false;
      const VectorXd derived = derived_values(task, rows, end);
      for (std::size_t r = 0; r < rows.size(); ++r) {
        fit.derived[r].low = std::min(fit.derived[r].low, derived[static_cast<Index>(r)]);
        fit.derived[r].high = std::max(fit.derived[r].high, derived[static_cast<Index>(r)]);
      }
    }
}

}  // namespace

VectorXd values_at(const FitTask& task, const VectorXd& coordinates) {
  return of_each_parameter(task, coordinates, &FreeParameter::value);
}

void put_information(const FitTask& task, const Information& known, const VectorXd& coordinates,
                     MediumFit& fit) {
  fit.coordinates = coordinates;
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
  const VectorXd derivatives = of_each_parameter(task, coordinates, &FreeParameter::derivative);
  return derivatives.asDiagonal() * covariance * derivatives.asDiagonal();
}

bool is_likely(double chi_squared, double degrees_of_freedom) {
  return chi_squared < degrees_of_freedom + 4 * std::sqrt(2 * degrees_of_freedom) + 4;
}

void check(const FitTask& task) {
  const FitData data(task);
  const std::size_t free = task.free.size();
  if (static_cast<Index>(free) > data.values().size())
    throw InputError("free", free,
                     "must not exceed the number of measured values, " +
                         std::to_string(data.values().size()) + "; free fewer keys");
  if (task.paths) return check_paths(task);
  SlabModel(curves_of(task), media_at(task, middle(task)));
}

MediumFit fit_medium(const FitTask& task) {
  if (task.paths) return fit_by_paths(task);
  FitData data(task);
  SlabModel model(curves_of(task), media_at(task, middle(task)));
  if (data.has_fields()) require_light(model.values(media_at(task, middle(task))));
  const BoundedLeastSquares problem = problem_of(task, model, data);
  MediumFit fit;
  LeastSquaresFit best = refined_fit(task, problem, model, data, fit);
  if (data.has_fields()) best = likeliest_fit(task, problem, model, std::move(best), data);
  put_information(task, information(problem, best.jacobian), best.parameters, fit);
  if (!data.has_fields()) put_intervals(task, problem, best, fit);
  fit.model = model.values(media_at(task, best.parameters));
  fit.residuals = best.residuals;
  fit.standardized_residuals = (data.values() - fit.model).cwiseQuotient(data.errors());
  fit.chi_squared = best.chi_squared();
  fit.degrees_of_freedom = degrees_of_freedom(best, data);
  fit.derivative_check = check_derivative(problem, best);
  fit.converged = best.converged;
  fit.reversed = model.reversed();
  fit.trace = best.trace;
  for (auto& step : fit.trace) step.parameters = values_at(task, step.parameters);
  return fit;
}

}  // namespace flatspeckle::mc
