#include "apps/fit/fit_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "apps/command/command_line.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "mc/fit/fit_datasets.h"

namespace flatspeckle::apps {

namespace {

struct ComparedFit {
  std::string path, scatterer;
  std::vector<double> measured;
  double chi_squared = 0, parameters = 0, freedom = 0;

  double information() const { return chi_squared + 2 * parameters; }
};

ComparedFit fit_of(const std::string& path) {
  const ResultReader file(path);
  if (!file.has("estimate") || !file.has("measured") || !file.has_attribute("/", "chi_squared"))
    throw InputError("compare", path, "must be a result of fit");
  ComparedFit fit;
  fit.path = path;
  fit.scatterer = value_in("scatterer", file.attribute<std::string>("/", "config"));
  fit.measured = file.dataset<double>("measured");
  fit.chi_squared = file.attribute<double>("/", "chi_squared");
  fit.parameters = static_cast<double>(file.dataset<double>("estimate").size());
  try {
    fit.freedom = file.attribute<double>("/", "degrees_of_freedom");
  } catch (const InputError&) {  // in results of earlier versions, the attribute is an integer
    fit.freedom = static_cast<double>(fit.measured.size()) - fit.parameters;
  }
  return fit;
}

/// Returns the probability that chi^2 is at least this large, by the approximation of Wilson and
/// Hilferty. freedom: degrees of freedom.
double tail_probability(double chi_squared, double freedom) {
  if (freedom < 1) return 1;
  const double width = 2 / (9 * freedom),
               normal = (std::cbrt(chi_squared / freedom) - 1 + width) / std::sqrt(width);
  return std::erfc(normal / std::sqrt(2)) / 2;
}

using Eigen::Index;

void print_chosen(const char* what, const std::vector<double>& chosen, std::size_t given) {
  std::printf("chosen %zu of %zu %s:", chosen.size(), given, what);
  for (const double angle : chosen) std::printf(" %.6g", angle);
  std::puts("");
}

void print_growth(const mc::PlanTask& task, const char* what, const std::vector<double>& angles,
                  const Eigen::MatrixXd& growth) {
  std::printf("factors by which the errors grow without one %s\n%-12s", what, "");
  for (const auto& free : task.free) std::printf(" %14s", free.key.c_str());
  for (Index i = 0; i < growth.rows(); ++i) {
    std::printf("\n%-12.6g", angles[static_cast<std::size_t>(i)]);
    for (Index j = 0; j < growth.cols(); ++j) std::printf(" %14.3g", growth(i, j));
  }
  std::puts("");
}

void print_correlations(const mc::FitTask& task, const mc::MediumFit& fit) {
  constexpr double strong = 0.9;
  for (std::size_t i = 0; i < task.free.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double r = fit.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      if (std::abs(r) > strong)
        std::printf("errors of %s and %s are correlated: %.3f\n", task.free[j].key.c_str(),
                    task.free[i].key.c_str(), r);
    }
}

/// Returns a remark to print after an estimate that is at one of its bounds, or that the data
/// determine no better than the bounds do. known: whether the data determine it better.
std::string remark(const mc::FreeParameter& parameter, double estimate, bool known) {
  const double nearest = std::min(estimate - parameter.lower, parameter.upper - estimate);
  if (nearest < 1e-6 * (parameter.upper - parameter.lower)) return "  at its bound";
  return known ? "" : "  not determined better than by its bounds";
}

/// Prints the expected bias of the estimates that is due to neglected wave effects. The printed
/// errors of the estimates include this bias.
void print_neglected(const mc::FitTask& task, const mc::MediumFit& fit) {
  const Eigen::VectorXd bias = fit.by_neglect.diagonal().cwiseSqrt();
  if (!(fit.by_neglect.trace() > 0)) return;
  std::printf("part of the errors due to wave effects neglected by paths:");
  for (std::size_t i = 0; i < task.free.size(); ++i)
    std::printf(" %s %.2g", task.free[i].key.c_str(), bias[static_cast<Eigen::Index>(i)]);
  std::puts("");
}

/// Prints the intervals of two standard errors by the profile of chi^2.
void print_intervals(const mc::FitTask& task, const mc::MediumFit& fit) {
  std::puts("chi^2 is not quadratic: judge by these intervals (chi^2 + 4), not by the errors");
  const auto line = [](const std::string& name, double low, double high) {
    std::printf("%-26s %12.6g to %-12.6g\n", name.c_str(), low, high);
  };
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    const auto j = static_cast<Index>(i);
    line(task.free[i].key, fit.low[j], fit.high[j]);
  }
  for (const mc::Derived& one : fit.derived)
    if (one.name == "reduced_scattering") line(one.name, one.low, one.high);
}

void print_parameters(const mc::FitTask& task, const mc::MediumFit& fit) {
  std::printf("%-26s %12s %10s\n", "parameter", "value", "error");
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    std::printf("%-26s %12.6g %10.2g%s\n", task.free[i].key.c_str(), fit.estimates[j],
                fit.errors[j], remark(task.free[i], fit.estimates[j], fit.known[i]).c_str());
  }
  for (const mc::Derived& one : fit.derived)
    if (std::ranges::find(task.free, one.name, &mc::FreeParameter::key) == task.free.end())
      std::printf("%-26s %12.6g %10.2g\n", one.name.c_str(), one.value, one.error);
  if (!fit.is_quadratic) print_intervals(task, fit);
}

}  // namespace

void print_compared_fits(const std::vector<std::string>& paths) {
  std::vector<ComparedFit> fits;
  for (const std::string& path : paths) {
    fits.push_back(guarded_read(path, [&] { return fit_of(path); }));
    if (fits.back().measured != fits.front().measured)
      throw InputError("compare", path, "must fit the same measurements as " + paths.front());
  }
  std::ranges::sort(fits, {}, &ComparedFit::information);
  double sum = 0;
  const auto weight = [&](const ComparedFit& fit) {
    return std::exp((fits.front().information() - fit.information()) / 2);
  };
  for (const ComparedFit& fit : fits) sum += weight(fit);
  std::printf("%-28s %-12s %10s %10s %10s %10s %10s\n", "fit", "scatterer", "parameters", "chi^2",
              "freedom", "p-value", "weight");
  for (const ComparedFit& fit : fits)
    std::printf("%-28s %-12s %10g %10.4g %10g %10.2g %10.2g\n", fit.path.c_str(),
                fit.scatterer.c_str(), fit.parameters, fit.chi_squared, fit.freedom,
                tail_probability(fit.chi_squared, fit.freedom), weight(fit) / sum);
}

void print_plan(const mc::PlanTask& task, const mc::FitPlan& plan) {
  std::printf("%-16s %12s %14s %20s\n", "parameter", "value", "least error", "patterns to 1 %");
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    const auto j = static_cast<Index>(i);
    std::printf("%-16s %12.6g %14.2g %20.2g\n", task.free[i].key.c_str(), plan.values[j],
                plan.errors[j], plan.patterns_to_percent[j]);
  }
  std::printf("from %g independent patterns of each view; condition number %.3g\n", task.patterns,
              plan.condition);
  if (task.most_tilts > 0) print_chosen("tilts", plan.tilts, task.scene.tilts.size());
  if (task.most_views > 0) print_chosen("views", plan.views, task.scene.view_angles.size());
  if (task.most_tilts + task.most_views > 0)
    std::printf("the choice increases the errors by factors of at most %.3g\n",
                plan.growth_by_choice.maxCoeff());
  if (plan.views.size() > 1) print_growth(task, "view", plan.views, plan.without_view);
  if (plan.tilts.size() > 1) print_growth(task, "tilt", plan.tilts, plan.without_tilt);
}

void print_plans(const mc::PlanTask& task, const std::vector<mc::PlanPoint>& points) {
  std::printf("number of independent patterns of each view required for an error of 1 %%\n%-36s",
              "");
  for (const auto& free : task.free) std::printf(" %14s", free.key.c_str());
  for (const mc::PlanPoint& point : points) {
    std::printf("\n%-36s", point.name.c_str());
    for (const double patterns : point.plan.patterns_to_percent) std::printf(" %14.2g", patterns);
  }
  std::puts("");
}

void print_fit(const mc::FitTask& task, const mc::MediumFit& fit) {
  print_parameters(task, fit);
  if (task.paths) print_neglected(task, fit);
  print_correlations(task, fit);
  std::printf("chi^2 %.4g for %td values and %zu parameters; condition number %.3g\n",
              fit.chi_squared, fit.residuals.size(), task.free.size(), fit.condition);
  const auto count = static_cast<double>(fit.residuals.size() - fit.estimates.size());
  if (fit.degrees_of_freedom < 0.95 * count)
    std::printf("errors of the values are correlated: chi^2 has %.3g degrees of freedom, not %g\n",
                fit.degrees_of_freedom, count);
  if (!mc::is_likely(fit.chi_squared, fit.degrees_of_freedom))
    std::printf(
        "chi^2 is unlikely: the model does not fit these measurements within their errors\n");
  if (const std::string words = mc::degeneracy(task, fit); !words.empty())
    std::printf("%s\n", words.c_str());
  constexpr double small = 0.1;
  if (fit.numerical > small)
    std::printf(
        "the numerical error of the model is up to %.2g standard errors of the measured values\n",
        fit.numerical);
  if (!fit.converged)
    std::printf("not converged after %zu steps: this is the best point so far\n", fit.trace.size());
}

}  // namespace flatspeckle::apps
