#include <cmath>

#include "apps/sweep/curve_result.h"
#include "core/error.h"
#include "core/result/run_state_file.h"

namespace flatspeckle::apps {

namespace {

template <typename Value>
std::vector<Value> kept_list(const FinishedPoint& finished, const std::string& name) {
  const CollectedDataset* const set = finished.result.find(name);
  if (set == nullptr) throw InputError("a finished point has no " + name);
  return std::get<std::vector<Value>>(set->values);
}

}  // namespace

PointResult point_result(const Scene& scene, const FieldJob& job, const RunState& state) {
  auto effect = mc::memory_effect(scene.request, state.sums, job.covariance);
  const double depth = scene.domain.depth;
  return {.correlation = std::move(effect.correlation),
          .correlation_error = std::move(effect.correlation_error),
          .correlation_rare = std::move(effect.correlation_rare),
          .range = effect.range.range.value * depth,
          .range_error = effect.range.error * depth,
          .range_rare = effect.range.rare,
          .range_censored = static_cast<std::uint64_t>(effect.range.range.censored),
          .trace = state.trace};
}

mc::Range range_in_q(const Scene& scene, const PointResult& point) {
  return {point.range / scene.domain.depth, mc::Range::Censoring(point.range_censored)};
}

std::vector<double> deviation(const PointResult& mc, const PointResult& wave) {
  constexpr double rounding = 1e-12;
  std::vector<double> deviation;
  for (std::size_t t = 0; t < mc.correlation.size(); ++t) {
    const double difference = mc.correlation[t] - wave.correlation[t];
    const double error = std::hypot(mc.correlation_error[t], wave.correlation_error[t]);
    deviation.push_back(error < rounding ? 0 : difference / error);
  }
  return deviation;
}

/// Under the names that they have in the result; what belongs together in one list.
void write_point(ResultFile& file, const PointResult& point) {
  const auto put = [&]<typename Value>(const char* name, const std::vector<Value>& values) {
    file.dataset(name, std::span(values), {values.size()}, "", "");
  };
  put("field_correlation", point.correlation);
  put("field_correlation_error", point.correlation_error);
  put("field_correlation_rare", point.correlation_rare);
  put("memory_effect_range", std::vector{point.range, point.range_error});
  put("range_marks", std::vector{point.range_rare, point.range_censored});
  write_trace(file, "", point.trace);
}

PointResult curve_of(const FinishedPoint& finished) {
  const auto numbers = [&](const std::string& name) { return kept_list<double>(finished, name); };
  const auto counts = [&](const char* name) { return kept_list<std::uint64_t>(finished, name); };
  const auto range = numbers("memory_effect_range");
  const auto marks = counts("range_marks");
  PointResult point{.correlation = numbers("field_correlation"),
                    .correlation_error = numbers("field_correlation_error"),
                    .correlation_rare = counts("field_correlation_rare"),
                    .range = range.at(0),
                    .range_error = range.at(1),
                    .range_rare = marks.at(0),
                    .range_censored = marks.at(1),
                    .trace = {},
                    .relative_error = finished.relative_error,
                    .samples = finished.samples,
                    .cpu_s = finished.cpu_s,
                    .wall_s = finished.wall_s};
  point.correlation_rare.resize(point.correlation.size());  // none where nothing is marked
  for (const auto& [name, values] : trace_columns)
    point.trace.*values = numbers(std::string("trace/") + name);
  return point;
}

}  // namespace flatspeckle::apps
