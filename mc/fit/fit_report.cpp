#include "mc/fit/fit_report.h"

#include <cmath>

#include "mc/fit/task/curve_values.h"
#include "mc/fit/task/fit_data.h"

namespace flatspeckle::mc {

namespace {

/// What describes a medium besides its keys.
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

/// A function of each parameter at its coordinate.
VectorXd of_each_parameter(const FitTask& task, const VectorXd& coordinates,
                           double (FreeParameter::*function)(double) const) {
  VectorXd found = coordinates;
  for (Index i = 0; i < found.size(); ++i)
    found[i] = (task.free[static_cast<std::size_t>(i)].*function)(coordinates[i]);
  return found;
}

/// Of the first curve's medium.
std::vector<Derived> derived_at(const FitTask& task, const VectorXd& at,
                                const MatrixXd& covariance) {
  const MovingSpec& spec = task.measurements.front().curves.front().scene;
  std::vector<DerivedRow> rows;
  for (const DerivedRow& row : derived_rows)
    if (!row.of_motion || task.moving()) rows.push_back(row);
  const auto count = std::ssize(rows);
  const auto values = [&](const VectorXd& x) {
    const Medium of(with_parameters(spec, task.free, x));
    VectorXd found(count);
    for (Index r = 0; r < count; ++r) found[r] = rows[static_cast<std::size_t>(r)].value(of);
    return found;
  };
  BoundedLeastSquares as_problem = bounds_of(task.free);
  as_problem.residuals = values;
  const VectorXd here = values(at);
  const MatrixXd slopes = jacobian(as_problem, at, here);
  const VectorXd error = (slopes * covariance * slopes.transpose()).diagonal().cwiseSqrt();
  std::vector<Derived> derived;
  for (Index r = 0; r < count; ++r) {
    const DerivedRow& row = rows[static_cast<std::size_t>(r)];
    derived.push_back({row.name, row.unit, here[r], error[r]});
  }
  return derived;
}

}  // namespace

VectorXd values_at(const FitTask& task, const VectorXd& coordinates) {
  return of_each_parameter(task, coordinates, &FreeParameter::value);
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
  const VectorXd slopes = of_each_parameter(task, coordinates, &FreeParameter::slope);
  return slopes.asDiagonal() * covariance * slopes.asDiagonal();
}

bool is_likely(double chi_squared, Index values, Index parameters) {
  const auto degrees = static_cast<double>(values - parameters);
  return chi_squared < degrees + 4 * std::sqrt(2 * degrees) + 4;
}

}  // namespace flatspeckle::mc
