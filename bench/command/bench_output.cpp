#include "bench/command/bench_output.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace flatspeckle::apps {

namespace {

/// A table of things that are numbered, column by column.
template <typename Row>
class Table {
 public:
  Table(ResultFile& file, std::string axis, const std::vector<Row>& rows,
        const std::string& long_name)
      : file_(file), axis_(std::move(axis)), rows_(rows) {
    file_.numbered_scale(axis_, rows_.size(), long_name);
  }

  template <typename Get>
  void texts(const std::string& name, const std::string& long_name, Get get) {
    std::vector<std::string> column;
    for (const Row& row : rows_) column.push_back(std::invoke(get, row));
    file_.dataset(name, column, {axis_}, long_name);
  }

  /// What is not finite becomes the largest number that is.
  template <typename Get>
  void numbers(const std::string& name, const std::string& units, const std::string& long_name,
               Get get) {
    std::vector<double> column;
    for (const Row& row : rows_) {
      const double value = std::invoke(get, row);
      column.push_back(std::isfinite(value) ? value : std::numeric_limits<double>::max());
    }
    file_.dataset(name, column, {axis_}, units, long_name);
  }

  template <typename Get>
  void counts(const std::string& name, const std::string& long_name, Get get) {
    std::vector<std::uint64_t> column;
    for (const Row& row : rows_)
      column.push_back(static_cast<std::uint64_t>(std::invoke(get, row)));
    file_.dataset(name, column, {axis_}, "1", long_name);
  }

 private:
  ResultFile& file_;
  std::string axis_;
  const std::vector<Row>& rows_;
};

struct CurvePoint {
  std::size_t curve;
  bench::ErrorPoint point;
};
struct CostPoint {
  std::size_t cost;
  double size, value;
};

}  // namespace

void write_error_curves(ResultFile& file, const std::vector<bench::ErrorCurve>& curves) {
  using bench::ErrorCurve;
  Table table(file, "curve", curves, "number of the curve");
  table.texts("scene", "standard scene", &ErrorCurve::scene);
  table.texts("method", "what estimates", &ErrorCurve::method);
  table.texts("reference", "how the true value is known", &ErrorCurve::reference);
  table.numbers("reference_uncertainty", "1", "relative error of the reference",
                &ErrorCurve::reference_error);
  table.numbers("slope", "1", "exponent of the error over processor time", &ErrorCurve::slope);
  table.numbers("slope_error", "1", "standard error of slope", &ErrorCurve::slope_error);
  table.numbers("efficiency", "1/s", "1/(error^2 processor time)", &ErrorCurve::efficiency);
  table.counts("is_monte_carlo", "whether the error falls with the square root of the samples",
               &ErrorCurve::is_monte_carlo);
  std::vector<CurvePoint> points;
  for (std::size_t c = 0; c < curves.size(); ++c)
    for (const auto& point : curves[c].points) points.push_back({c, point});
  Table all(file, "curve_point", points, "points of all curves, one curve after the other");
  all.counts("of_curve", "number of the point's curve", &CurvePoint::curve);
  all.numbers("cpu_s", "s", "processor time", [](const auto& p) { return p.point.cpu_s; });
  all.numbers("samples", "1", "samples by then", [](const auto& p) { return p.point.samples; });
  all.numbers("relative_error", "1", "RMS deviation from the reference over the RMS of its values",
              [](const auto& p) { return p.point.error; });
  all.numbers("relative_error_error", "1", "standard error of relative_error",
              [](const auto& p) { return p.point.error_error; });
}

void write_cost_curves(ResultFile& file, const std::vector<bench::CostCurve>& costs) {
  using bench::CostCurve;
  Table table(file, "cost", costs, "number of the cost curve");
  table.texts("task", "whose cost it is", &CostCurve::what);
  table.texts("cost_name", "what its cost is", &CostCurve::cost_name);
  table.texts("size_name", "what its size is", &CostCurve::size_name);
  table.numbers("exponent", "1", "fitted exponent of cost over size", &CostCurve::exponent);
  table.numbers("exponent_error", "1", "standard error of exponent", &CostCurve::exponent_error);
  table.numbers("expected_exponent", "1", "exponent by theory", &CostCurve::expected);
  std::vector<CostPoint> points;
  for (std::size_t c = 0; c < costs.size(); ++c)
    for (std::size_t i = 0; i < costs[c].size.size(); ++i)
      points.push_back({c, costs[c].size[i], costs[c].cpu_s[i]});
  Table all(file, "cost_point", points, "points of all cost curves, one curve after the other");
  all.counts("of_cost", "number of the point's cost curve", &CostPoint::cost);
  all.numbers("size", "1", "size of the problem", &CostPoint::size);
  all.numbers("cost_value", "1", "cost, in what cost_name says", &CostPoint::value);
}

void write_cases(ResultFile& file, const std::vector<ExaminedCase>& cases) {
  Table table(file, "case", cases, "number of the case");
  const auto of_case = [](auto member) {
    return [=](const ExaminedCase& row) { return row.extreme.*member; };
  };
  table.texts("room", "part of the program", of_case(&bench::ExtremeCase::room));
  table.texts("name", "what is extreme", of_case(&bench::ExtremeCase::name));
  table.texts("invariant", "what was checked", of_case(&bench::ExtremeCase::invariant));
  table.texts("must_say", "what a refusal has to say; empty where the case must be solved",
              of_case(&bench::ExtremeCase::must_say));
  table.texts("refusal", "the message of a refusal; empty where the case was solved",
              [](const ExaminedCase& row) { return row.finding.refusal; });
  table.numbers("figure", "1", "how far the invariant was off",
                [](const ExaminedCase& row) { return row.finding.figure; });
  table.numbers("limit", "1", "what it was held to",
                [](const ExaminedCase& row) { return row.finding.limit; });
  table.counts("passed", "1: right within the limit, or refused as it must",
               [](const ExaminedCase& row) { return passes(row.extreme, row.finding); });
  table.numbers("cpu_s", "s", "processor time", &ExaminedCase::cpu_s);
}

void write_plan_rows(ResultFile& file, const std::vector<bench::PlanRow>& rows) {
  using bench::PlanRow;
  Table table(file, "comparison", rows, "number of the comparison");
  table.texts("room", "part of the program", &PlanRow::room);
  table.texts("left_out", "what the specialised kernel leaves out", &PlanRow::left_out);
  table.texts("scene", "that has no need of it", &PlanRow::scene);
  table.texts("per", "what the times are for", &PlanRow::per);
  table.numbers("general_s", "s", "processor time of the general kernel, median",
                &PlanRow::general_s);
  table.numbers("special_s", "s", "processor time of the specialised kernel, median",
                &PlanRow::special_s);
  table.numbers("ratio", "1", "general over specialised, median over slices taken in turn",
                &PlanRow::ratio);
  table.numbers("ratio_spread", "1", "half the distance of its quartiles", &PlanRow::ratio_spread);
  table.numbers("difference", "1", "largest difference of the results", &PlanRow::difference);
  table.texts("difference_in", "relative, or in standard errors where random numbers differ",
              &PlanRow::difference_in);
  table.numbers("limit", "1", "what the difference was held to", &PlanRow::limit);
  table.counts("passed", "whether the difference is within the limit",
               [](const PlanRow& row) { return bench::passes(row); });
}

}  // namespace flatspeckle::apps
