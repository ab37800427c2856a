#include "apps/fit/plan_summary.h"

#include <cstdio>

namespace flatspeckle::apps {

namespace {

using Eigen::Index;

void print_growth(const mc::PlanTask& task, const char* what, const std::vector<double>& angles,
                  const Eigen::MatrixXd& growth) {
  std::printf("without %-8s errors are larger by\n%-12s", what, "");
  for (const auto& free : task.free) std::printf(" %14s", free.key.c_str());
  for (Index i = 0; i < growth.rows(); ++i) {
    std::printf("\n%-12.6g", angles[static_cast<std::size_t>(i)]);
    for (Index j = 0; j < growth.cols(); ++j) std::printf(" %14.3g", growth(i, j));
  }
  std::puts("");
}

}  // namespace

void print_plan(const mc::PlanTask& task, const mc::FitPlan& plan) {
  std::printf("%-16s %12s %14s %20s\n", "parameter", "value", "least error", "patterns to 1 %");
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    const auto j = static_cast<Index>(i);
    std::printf("%-16s %12.6g %14.2g %20.2g\n", task.free[i].key.c_str(), plan.values[j],
                plan.errors[j], plan.patterns_to_percent[j]);
  }
  std::printf("from %g independent patterns of each view; condition %.3g\n", task.patterns,
              plan.condition);
  if (plan.views.size() > 1) print_growth(task, "view", plan.views, plan.without_view);
  if (plan.tilts.size() > 1) print_growth(task, "tilt", plan.tilts, plan.without_tilt);
}

void print_plans(const mc::PlanTask& task, const std::vector<mc::PlanPoint>& points) {
  std::printf("independent patterns of each view to 1 %%\n%-36s", "");
  for (const auto& free : task.free) std::printf(" %14s", free.key.c_str());
  for (const mc::PlanPoint& point : points) {
    std::printf("\n%-36s", point.name.c_str());
    for (const double patterns : point.plan.patterns_to_percent) std::printf(" %14.2g", patterns);
  }
  std::puts("");
}

}  // namespace flatspeckle::apps
