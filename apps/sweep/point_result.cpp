#include "apps/sweep/point_result.h"

#include <cmath>

#include "core/error.h"
#include "core/result/result_group.h"
#include "core/result/run_state_file.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

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
          .relative_error = state.trace.relative_error.back(),
          .samples = state.sums.total_samples(),
          .cpu_s = state.cpu_s,
          .wall_s = state.wall_s,
          .reached = true,
          .plan = {},
          .started = {},
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

void write_point(ResultFile& file, const PointResult& point, const Scene& scene) {
  write_axes(file, scene);
  file.bind("MOVES", {"tilt"});
  const ResultGroup root(file, mc::moves_table);
  root.put("field_correlation", point.correlation, point.correlation_error, point.correlation_rare);
  root.put("memory_effect_range", Estimate{{point.range}, {point.range_error}, {point.range_rare}});
  file.attribute("/", "range_censored", point.range_censored);
  file.attribute("/", "relative_error", point.relative_error);
  file.attribute("/", "reached", point.reached);
  write_trace(file, "", point.trace);
}

PointResult read_point(const ResultReader& file) {
  const auto tilts = file.shape("tilt");
  for (const char* name : {"field_correlation", "field_correlation_error"})
    if (file.shape(name) != tilts) throw InputError(std::string(name) + " is not one per tilt");
  const auto scalar = [&](const char* name) {
    const auto values = file.dataset<double>(name);
    if (values.size() != 1) throw InputError(std::string(name) + " is not one number");
    return values.front();
  };
  const auto rare = [&](const std::string& name) {
    const auto values = file.dataset<double>(name);
    if (!file.has(name + "_rare")) return std::vector<std::uint64_t>(values.size());
    const auto marks = file.dataset<double>(name + "_rare");
    if (marks.size() != values.size()) throw InputError(name + "_rare is not one per " + name);
    return column(marks, [](double mark) { return std::uint64_t{mark != 0}; });
  };
  const auto attribute = [&](const char* name) { return file.attribute<double>("/", name); };
  return {.correlation = file.dataset<double>("field_correlation"),
          .correlation_error = file.dataset<double>("field_correlation_error"),
          .correlation_rare = rare("field_correlation"),
          .range = scalar("memory_effect_range"),
          .range_error = scalar("memory_effect_range_error"),
          .range_rare = rare("memory_effect_range").front(),
          .range_censored = file.attribute<std::uint64_t>("/", "range_censored"),
          .relative_error = attribute("relative_error"),
          .samples = attribute("samples"),
          .cpu_s = attribute("cpu_s"),
          .wall_s = attribute("wall_s"),
          .reached = file.attribute<bool>("/", "reached"),
          .plan = file.attribute<std::string>("/", "plan"),
          .started = file.attribute<std::string>("/", "started"),
          .trace = read_trace(file, "")};
}

}  // namespace flatspeckle::apps
