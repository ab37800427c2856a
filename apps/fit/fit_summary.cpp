#include "apps/fit/fit_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mc/fit/fit_datasets.h"
#include "mc/fit/fit_report.h"

namespace flatspeckle::apps {

namespace {

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

/// What a reader of the estimate has to know of it.
std::string remark(const mc::FreeParameter& parameter, double estimate, bool known) {
  const double nearest = std::min(estimate - parameter.lower, parameter.upper - estimate);
  if (nearest < 1e-6 * (parameter.upper - parameter.lower)) return "  at its bound";
  return known ? "" : "  not known better than by its bounds";
}

/// The bias that is to be expected of the estimates, which their errors hold.
void print_neglected(const mc::FitTask& task, const mc::MediumFit& fit) {
  const Eigen::VectorXd bias = fit.by_neglect.diagonal().cwiseSqrt();
  if (!(fit.by_neglect.trace() > 0)) return;
  std::printf("of the errors, what paths neglect of waves:");
  for (std::size_t i = 0; i < task.free.size(); ++i)
    std::printf(" %s %.2g", task.free[i].key.c_str(), bias[static_cast<Eigen::Index>(i)]);
  std::puts("");
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
}

}  // namespace

void print_fit(const mc::FitTask& task, const mc::MediumFit& fit) {
  print_parameters(task, fit);
  if (task.paths) print_neglected(task, fit);
  print_correlations(task, fit);
  std::printf("chi^2 %.4g of %td values less %zu parameters; condition %.3g\n", fit.chi_squared,
              fit.residuals.size(), task.free.size(), fit.condition);
  if (!mc::is_likely(fit.chi_squared, fit.residuals.size(), fit.estimates.size()))
    std::printf("chi^2 is unlikely: this model cannot give these measurements with their errors\n");
  if (const std::string words = mc::degeneracy(task, fit); !words.empty())
    std::printf("%s\n", words.c_str());
  constexpr double small = 0.1;
  if (fit.numerical > small)
    std::printf("the model's numerical error is up to %.2g standard errors\n", fit.numerical);
  if (!fit.converged)
    std::printf("not converged after %zu steps: this is the best point so far\n", fit.trace.size());
}

}  // namespace flatspeckle::apps
