#include "mc/fit/plan/plan_datasets.h"

#include <cmath>

#include "core/algebra/row_major.h"
#include "core/result/result_group.h"

namespace flatspeckle::mc {

const DatasetTable plan_table{
    .name = "fit plan",
    .rows = {{"parameter", Data::numbers, "", "1", "number of the free key"},
             {"parameter_2", Data::numbers, "", "1", "number of the second free key"},
             {"parameter_name", Data::text, "parameter", "", "its name"},
             {"planned", Data::estimate, "parameter", "", "its value, with the least error"},
             {"parameter_correlation", Data::real, "parameter parameter_2", "1",
              "correlation of the estimates' errors"},
             {"patterns_to_percent", Data::real, "parameter", "1",
              "patterns that make the error a hundredth of the value"},
             {"view_angle", Data::scale, "", "rad", "direction of view, from +z towards +x"},
             {"tilt", Data::scale, "", "rad", "rotation of the light"},
             {"growth_without_view", Data::real, "view_angle parameter", "1",
              "error without this view over that with all"},
             {"growth_without_tilt", Data::real, "tilt parameter", "1",
              "error without this tilt over that with all"},
             {"point", Data::numbers, "", "1", "number of the plan, of several"},
             {"point_name", Data::text, "point", "", "what is varied there"},
             {"point_planned", Data::estimate, "point parameter", "",
              "value there, with the least error"},
             {"point_patterns_to_percent", Data::real, "point parameter", "1",
              "patterns that make the error there a hundredth of the value"}},
    .attributes = {{"", "patterns", "float64", "independent patterns of each view"},
                   {"", "condition", "float64",
                    "largest over least eigenvalue of the information, parameters in distances of "
                    "their bounds; absent where a combination is not known at all"}}};

void write_plan(ResultFile& file, const PlanTask& task, const FitPlan& plan) {
  const ResultGroup root(file, plan_table);
  root.number("parameter", task.free.size());
  root.number("parameter_2", task.free.size());
  root.put("parameter_name", column(task.free, &FreeParameter::key));
  root.put("planned", row_major(plan.values), row_major(plan.errors));
  root.put("parameter_correlation", row_major(plan.correlation));
  root.put("patterns_to_percent", row_major(plan.patterns_to_percent));
  root.put("view_angle", plan.views);
  root.put("tilt", plan.tilts);
  root.put("growth_without_view", row_major(plan.without_view));
  root.put("growth_without_tilt", row_major(plan.without_tilt));
  root.attribute("patterns", task.patterns);
  if (std::isfinite(plan.condition)) root.attribute("condition", plan.condition);
}

void write_plans(ResultFile& file, const PlanTask& task, const std::vector<PlanPoint>& points) {
  const ResultGroup root(file, plan_table);
  std::vector<double> values, errors, patterns;
  const auto append = [](std::vector<double>& all, const Eigen::VectorXd& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  for (const PlanPoint& point : points) {
    append(values, point.plan.values);
    append(errors, point.plan.errors);
    append(patterns, point.plan.patterns_to_percent);
  }
  root.number("parameter", task.free.size());
  root.put("parameter_name", column(task.free, &FreeParameter::key));
  root.number("point", points.size());
  root.put("point_name", column(points, &PlanPoint::name));
  root.put("point_planned", values, errors);
  root.put("point_patterns_to_percent", patterns);
  root.attribute("patterns", task.patterns);
}

}  // namespace flatspeckle::mc
