#include "mc/fit/fit_datasets.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "core/algebra/dense.h"
#include "core/result/result_group.h"

namespace flatspeckle::mc {

const DatasetTable fit_table{
    .name = "fit",
    .rows =
        {{"parameter", Data::numbers, "", "1", "number of the free key"},
         {"parameter_2", Data::numbers, "", "1", "number of the second free key"},
         {"parameter_name", Data::text, "parameter", "", "name of the free key"},
         {"estimate", Data::estimate, "parameter", "", "the value that fits best"},
         {"lower_bound", Data::real, "parameter", "", "least value that is accepted"},
         {"upper_bound", Data::real, "parameter", "", "largest value that is accepted"},
         {"interval_low", Data::real, "parameter", "",
          "lower end of the interval of two standard errors: chi_squared, minimised over the other "
          "parameters, exceeds its minimum by 4"},
         {"interval_high", Data::real, "parameter", "", "upper end of this interval"},
         {"known", Data::count, "parameter", "1",
          "1 if the error is less than a quarter of the distance between the bounds, else 0"},
         {"parameter_covariance", Data::real, "parameter parameter_2", "",
          "covariance of the estimates' errors"},
         {"chance_covariance", Data::real, "parameter parameter_2", "",
          "part of parameter_covariance from the sampling noise of a Monte Carlo model"},
         {"neglected_covariance", Data::real, "parameter parameter_2", "",
          "part of parameter_covariance from the wave effects that a Monte Carlo model neglects"},
         {"parameter_correlation", Data::real, "parameter parameter_2", "1",
          "correlation of the estimates' errors"},
         {"worst_combination", Data::real, "parameter", "1",
          "least determined combination of coordinates, a vector of length 1; unit: the distance "
          "between the bounds"},
         {"derived", Data::numbers, "", "1", "number of the derived quantity"},
         {"derived_name", Data::text, "derived", "", "name of the derived quantity"},
         {"derived_value", Data::estimate, "derived", "", "value of the derived quantity"},
         {"derived_low", Data::real, "derived", "",
          "least value at the ends of the intervals of the parameters"},
         {"derived_high", Data::real, "derived", "", "largest value at these ends"},
         {"measurement", Data::numbers, "", "1", "number of the measurement"},
         {"measurement_name", Data::text, "measurement", "", "file of the measurement"},
         {"datum", Data::numbers, "", "1", "number of the measured value"},
         {"datum_measurement", Data::count, "datum", "1",
          "number of the measurement that contains the value"},
         {"datum_curve", Data::count, "datum", "1",
          "number of the curve that contains the value, counted over all measurements"},
         {"datum_observable", Data::text, "datum", "", "what was measured"},
         {"datum_angle", Data::real, "datum", "rad",
          "tilt; view angle of intensities; light angle of powers; 0 for delays and exposures"},
         {"datum_time", Data::real, "datum", "1",
          "delay or exposure, all in the same unit of time; 0 for other values"},
         {"datum_distance", Data::real, "datum", "length",
          "distance of the detector from the beam; 0 for other values"},
         {"measured", Data::estimate, "datum", "", "measured value"},
         {"model", Data::real, "datum", "", "value for the medium that fits best"},
         {"pull", Data::real, "datum", "1", "measured - model, in standard errors"},
         {"residual", Data::real, "datum", "1",
          "model - measured, transformed to independent standard errors; chi^2 is the sum of "
          "squares"},
         {"iteration", Data::numbers, "", "1", "number of the accepted step"},
         {"trace_parameter", Data::real, "iteration parameter", "",
          "value of the parameter at this step"},
         {"trace_chi_squared", Data::real, "iteration", "1", "chi^2 at this step"},
         {"trace_cpu_s", Data::real, "iteration", "s", "processor time until this step"},
         {"invariants/derivatives", Data::invariant, "", "1",
          "relative difference between the derivatives of the residuals and finite differences, by "
          "the parameter that the residuals determine best"}},
    .attributes = {
        {"", "chi_squared", "float64", "sum of the squared residuals"},
        {"", "degrees_of_freedom", "float64",
         "expected chi_squared if the medium is correct: values minus parameters, or less if the "
         "errors of the values are strongly correlated"},
        {"", "condition", "float64",
         "ratio of the largest to the least eigenvalue of the information, with parameters in "
         "units of the distance between their bounds; absent if a combination is not determined at "
         "all"},
        {"", "numerical_error", "float64",
         "largest numerical error of the model, in standard errors; 0 for Monte Carlo"},
        {"", "degeneracy", "text", "which parameters are well and which are poorly determined"}}};

namespace {

void write_parameters(const ResultGroup& root, const FitTask& task, const MediumFit& fit) {
  root.number("parameter", task.free.size());
  root.number("parameter_2", task.free.size());
  root.put("parameter_name", column(task.free, &FreeParameter::key));
  root.put("estimate", row_major(fit.estimates), row_major(fit.errors));
  root.put("lower_bound", column(task.free, &FreeParameter::lower));
  root.put("upper_bound", column(task.free, &FreeParameter::upper));
  if (fit.low.size() > 0) {
    root.put("interval_low", row_major(fit.low));
    root.put("interval_high", row_major(fit.high));
  }
  root.put("known", std::vector<std::uint64_t>(fit.known.begin(), fit.known.end()));
  root.put("parameter_covariance", row_major(fit.covariance));
  if (task.paths) {
    root.put("chance_covariance", row_major(fit.by_sampling));
    root.put("neglected_covariance", row_major(fit.by_neglect));
  }
  root.put("parameter_correlation", row_major(fit.correlation));
  root.put("worst_combination", row_major(fit.worst));
  root.number("derived", fit.derived.size());
  root.put("derived_name", column(fit.derived, &Derived::name));
  root.put("derived_value", column(fit.derived, &Derived::value),
           column(fit.derived, &Derived::error));
  if (fit.low.size() > 0) {
    root.put("derived_low", column(fit.derived, &Derived::low));
    root.put("derived_high", column(fit.derived, &Derived::high));
  }
}

void write_data(const ResultGroup& root, const FitTask& task, const MediumFit& fit) {
  std::vector<std::uint64_t> measurements, curves;
  std::vector<std::string> observables;
  std::vector<double> angles, times, distances, values, errors;
  std::uint64_t measurement = 0, number = 0;
  for (const Measurement& one : task.measurements) {
    for (const Curve& curve : one.curves) {
      for (std::size_t i = 0; i < curve.abscissa.size(); ++i) {
        const double at = curve.abscissa[i];
        measurements.push_back(measurement);
        curves.push_back(number);
        observables.push_back(observable_words[static_cast<std::size_t>(curve.observable)]);
        angles.push_back(curve.moving() || curve.distances ? 0 : at);
        times.push_back(curve.moving() ? at : 0);
        distances.push_back(curve.distances ? curve.distances->detectors[i].distance : 0);
      }
      ++number;
    }
    const auto more = row_major(one.values),
               uncertain = row_major(one.covariance.diagonal().cwiseSqrt());
    values.insert(values.end(), more.begin(), more.end());
    errors.insert(errors.end(), uncertain.begin(), uncertain.end());
    ++measurement;
  }
  root.number("measurement", task.measurements.size());
  root.put("measurement_name", column(task.measurements, &Measurement::name));
  root.number("datum", values.size());
  root.put("datum_measurement", measurements);
  root.put("datum_curve", curves);
  root.put("datum_observable", observables);
  root.put("datum_angle", angles);
  if (task.moving()) root.put("datum_time", times);
  if (task.at_distances()) root.put("datum_distance", distances);
  root.put("measured", values, errors);
  root.put("model", row_major(fit.model));
  root.put("pull", row_major(fit.standardized_residuals));
  root.put("residual", row_major(fit.residuals));
}

void write_trace(const ResultGroup& root, const MediumFit& fit) {
  std::vector<double> parameters;
  for (const auto& step : fit.trace)
    parameters.insert(parameters.end(), step.parameters.begin(), step.parameters.end());
  root.number("iteration", fit.trace.size());
  root.put("trace_parameter", parameters);
  root.put("trace_chi_squared", column(fit.trace, &LeastSquaresFit::Step::chi_squared));
  root.put("trace_cpu_s", column(fit.trace, &LeastSquaresFit::Step::cpu_s));
}

std::string percent(double share) {
  std::ostringstream text;
  text.precision(2);
  text << 100 * share << " %";
  return text.str();
}

}  // namespace

std::string degeneracy(const FitTask& task, const MediumFit& fit) {
  constexpr double much = 3;
  const std::set<std::string> beside_medium = {"diffusion", "velocity_x", "velocity_z", "shear",
                                           "beta",      "detector_scale"};
  const Derived& joint = fit.derived.front();
  const double known = joint.error / std::abs(joint.value);
  std::string worst;
  double least = 0;
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const double error = fit.errors[j] / std::abs(fit.estimates[j]);
    if (!(error > least) || beside_medium.contains(task.free[i].key)) continue;
    worst = task.free[i].key;
    least = error;
  }
  if (!(known > 0 && least > much * known)) return "";
  return "mu_s (1 - g) is known to " + percent(known) + ", " + worst + " alone to " +
         percent(least);
}

void write_fit(ResultFile& file, const FitTask& task, const MediumFit& fit) {
  const ResultGroup root(file, fit_table);
  write_parameters(root, task, fit);
  write_data(root, task, fit);
  write_trace(root, fit);
  if (fit.derivative_check) root.check("invariants/derivatives", *fit.derivative_check);
  root.attribute("chi_squared", fit.chi_squared);
  root.attribute("degrees_of_freedom", fit.degrees_of_freedom);
  if (std::isfinite(fit.condition)) root.attribute("condition", fit.condition);
  root.attribute("numerical_error", fit.numerical);
  root.attribute("degeneracy", degeneracy(task, fit));
}

}  // namespace flatspeckle::mc
