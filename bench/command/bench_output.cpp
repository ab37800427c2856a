#include "bench/command/bench_output.h"

#include <cmath>
#include <limits>

#include "apps/results/datasets.h"
#include "core/result/result_group.h"

namespace flatspeckle::apps {

namespace {

const DatasetTable error_table{
    "error",
    {{"curve", Data::numbers, "", "1", "number of the curve"},
     {"scene", Data::text, "curve", "", "standard scene"},
     {"method", Data::text, "curve", "", "estimator or solver"},
     {"reference", Data::text, "curve", "", "origin of the reference values"},
     {"reference_uncertainty", Data::real, "curve", "1", "relative error of the reference"},
     {"slope", Data::estimate, "curve", "1", "slope of log error against log processor time"},
     {"efficiency", Data::real, "curve", "1/s", "1/(error^2 processor time)"},
     {"is_monte_carlo", Data::count, "curve", "1", "1: the error should fall as 1 / sqrt(samples)"},
     {"curve_point", Data::numbers, "", "1", "points of all curves, one curve after the other"},
     {"of_curve", Data::count, "curve_point", "1", "number of the curve that contains the point"},
     {"cpu_s", Data::real, "curve_point", "s", "processor time"},
     {"samples", Data::real, "curve_point", "1", "samples up to this point"},
     {"relative_error", Data::estimate, "curve_point", "1",
      "RMS deviation from the reference over the RMS of its values"}}};

const DatasetTable cost_table{
    "cost",
    {{"cost", Data::numbers, "", "1", "number of the cost curve"},
     {"task", Data::text, "cost", "", "task whose cost is measured"},
     {"cost_name", Data::text, "cost", "", "quantity taken as cost"},
     {"size_name", Data::text, "cost", "", "quantity taken as size"},
     {"exponent", Data::estimate, "cost", "1", "fitted exponent: cost grows as size^exponent"},
     {"expected_exponent", Data::real, "cost", "1", "exponent expected from theory"},
     {"cost_point", Data::numbers, "", "1", "points of all cost curves, one curve after the other"},
     {"of_cost", Data::count, "cost_point", "1",
      "number of the cost curve that contains the point"},
     {"size", Data::real, "cost_point", "1", "size of the problem"},
     {"cost_value", Data::real, "cost_point", "1", "cost, in the unit given by cost_name"}}};

const DatasetTable stability_table{
    "stability",
    {{"case", Data::numbers, "", "1", "number of the case"},
     {"module", Data::text, "case", "", "part of the program"},
     {"name", Data::text, "case", "", "extreme condition"},
     {"invariant", Data::text, "case", "", "invariant that was checked"},
     {"must_say", Data::text, "case", "",
      "text required in the error message; empty if the case must be solved"},
     {"refusal", Data::text, "case", "", "error message; empty if the case was solved"},
     {"figure", Data::real, "case", "1", "deviation from the invariant"},
     {"limit", Data::real, "case", "1", "largest deviation that passes"},
     {"passed", Data::count, "case", "1",
      "1: within the limit, or rejected with the required message"},
     {"cpu_s", Data::real, "case", "s", "processor time"}}};

const DatasetTable plan_table{
    "plan",
    {{"comparison", Data::numbers, "", "1", "number of the comparison"},
     {"module", Data::text, "comparison", "", "part of the program"},
     {"left_out", Data::text, "comparison", "", "feature that the specialised kernel omits"},
     {"scene", Data::text, "comparison", "", "scene that does not need the feature"},
     {"per", Data::text, "comparison", "", "unit of work that the times refer to"},
     {"general_s", Data::real, "comparison", "s", "processor time of the general kernel, median"},
     {"special_s", Data::real, "comparison", "s",
      "processor time of the specialised kernel, median"},
     {"ratio", Data::real, "comparison", "1",
      "general_s / special_s, median over rounds in which both kernels run in turn"},
     {"ratio_spread", Data::real, "comparison", "1", "half the interquartile range of the ratio"},
     {"difference", Data::real, "comparison", "1", "largest difference of the results"},
     {"difference_in", Data::text, "comparison", "",
      "unit of the difference: relative, or standard errors if random numbers differ"},
     {"limit", Data::real, "comparison", "1", "largest difference that passes"},
     {"passed", Data::count, "comparison", "1", "1: the difference is within the limit"}}};

/// Returns a column in which values that are not finite are replaced by the largest finite number.
template <class Things, class Value>
std::vector<double> finite(const Things& things, const Value& value) {
  auto values = column(things, value);
  for (double& each : values)
    if (!std::isfinite(each)) each = std::numeric_limits<double>::max();
  return values;
}

}  // namespace

std::span<const DatasetTable* const> bench_tables() {
  static constexpr const DatasetTable* tables[] = {&error_table, &cost_table, &stability_table,
                                                   &plan_table};
  return tables;
}

void write_error_curves(ResultFile& file, const std::vector<bench::ErrorCurve>& curves) {
  using bench::ErrorCurve, bench::ErrorPoint;
  std::vector<std::size_t> of_curve;
  std::vector<ErrorPoint> points;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    of_curve.resize(of_curve.size() + curves[c].points.size(), c);
    points.insert(points.end(), curves[c].points.begin(), curves[c].points.end());
  }
  const ResultGroup root(file, error_table);
  root.number("curve", curves.size());
  root.put("scene", column(curves, &ErrorCurve::scene));
  root.put("method", column(curves, &ErrorCurve::method));
  root.put("reference", column(curves, &ErrorCurve::reference));
  root.put("reference_uncertainty", finite(curves, &ErrorCurve::reference_error));
  root.put("slope", finite(curves, &ErrorCurve::slope), finite(curves, &ErrorCurve::slope_error));
  root.put("efficiency", finite(curves, &ErrorCurve::efficiency));
  root.put("is_monte_carlo", column(curves, &ErrorCurve::is_monte_carlo));
  root.number("curve_point", points.size());
  root.put("of_curve", column(of_curve, std::identity()));
  root.put("cpu_s", finite(points, &ErrorPoint::cpu_s));
  root.put("samples", finite(points, &ErrorPoint::samples));
  root.put("relative_error", finite(points, &ErrorPoint::error),
           finite(points, &ErrorPoint::error_error));
}

void write_cost_curves(ResultFile& file, const std::vector<bench::CostCurve>& costs) {
  using bench::CostCurve;
  std::vector<std::size_t> of_cost;
  std::vector<double> size, value;
  for (std::size_t c = 0; c < costs.size(); ++c) {
    of_cost.resize(of_cost.size() + costs[c].size.size(), c);
    size.insert(size.end(), costs[c].size.begin(), costs[c].size.end());
    value.insert(value.end(), costs[c].cpu_s.begin(), costs[c].cpu_s.end());
  }
  const ResultGroup root(file, cost_table);
  root.number("cost", costs.size());
  root.put("task", column(costs, &CostCurve::what));
  root.put("cost_name", column(costs, &CostCurve::cost_name));
  root.put("size_name", column(costs, &CostCurve::size_name));
  root.put("exponent", finite(costs, &CostCurve::exponent),
           finite(costs, &CostCurve::exponent_error));
  root.put("expected_exponent", finite(costs, &CostCurve::expected));
  root.number("cost_point", size.size());
  root.put("of_cost", column(of_cost, std::identity()));
  root.put("size", finite(size, std::identity()));
  root.put("cost_value", finite(value, std::identity()));
}

void write_cases(ResultFile& file, const std::vector<ExaminedCase>& cases) {
  const ResultGroup root(file, stability_table);
  const auto extremes = column(cases, &ExaminedCase::extreme);
  const auto findings = column(cases, &ExaminedCase::finding);
  root.number("case", cases.size());
  root.put("module", column(extremes, &bench::ExtremeCase::module_name));
  root.put("name", column(extremes, &bench::ExtremeCase::name));
  root.put("invariant", column(extremes, &bench::ExtremeCase::invariant));
  root.put("must_say", column(extremes, &bench::ExtremeCase::must_say));
  root.put("refusal", column(findings, &bench::Finding::refusal));
  root.put("figure", finite(findings, &bench::Finding::figure));
  root.put("limit", finite(findings, &bench::Finding::limit));
  root.put("passed",
           column(cases, [](const ExaminedCase& row) { return passes(row.extreme, row.finding); }));
  root.put("cpu_s", finite(cases, &ExaminedCase::cpu_s));
}

void write_plan_rows(ResultFile& file, const std::vector<bench::PlanRow>& rows) {
  using bench::PlanRow;
  const ResultGroup root(file, plan_table);
  root.number("comparison", rows.size());
  root.put("module", column(rows, &PlanRow::module_name));
  root.put("left_out", column(rows, &PlanRow::left_out));
  root.put("scene", column(rows, &PlanRow::scene));
  root.put("per", column(rows, &PlanRow::per));
  root.put("general_s", finite(rows, &PlanRow::general_s));
  root.put("special_s", finite(rows, &PlanRow::special_s));
  root.put("ratio", finite(rows, &PlanRow::ratio));
  root.put("ratio_spread", finite(rows, &PlanRow::ratio_spread));
  root.put("difference", finite(rows, &PlanRow::difference));
  root.put("difference_in", column(rows, &PlanRow::difference_in));
  root.put("limit", finite(rows, &PlanRow::limit));
  root.put("passed", column(rows, [](const PlanRow& row) { return bench::passes(row); }));
}

}  // namespace flatspeckle::apps
