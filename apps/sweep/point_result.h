#pragma once

#include <string>
#include <vector>

#include "core/result/result_file.h"
#include "core/result/result_reader.h"
#include "core/run/runner.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::apps {

/// What one point of a sweep gives: its curve, the range read off it, and what it cost.
struct PointResult {
  std::vector<double> correlation, correlation_error;  ///< C_E [tilt]
  std::vector<std::uint64_t> correlation_rare;         ///< see Estimate
  double range = 0, range_error = 0;                   ///< q L at C_I = 1/2
  std::uint64_t range_rare = 0;                        ///< see Estimate
  std::uint64_t range_censored = 0;                    ///< mc::Range::Censoring
  double relative_error = 0, samples = 0, cpu_s = 0, wall_s = 0;
  bool reached = true;  ///< the target error, if there was one
  std::string plan, started;
  Trace trace;
};

/// Of a run that has ended.
PointResult point_result(const Scene& scene, const FieldJob& job, const RunState& state);

/// The range as its curve is stepped through: in q.
mc::Range range_in_q(const Scene& scene, const PointResult& point);

/// Difference of the curves of two methods in combined standard errors, per tilt; 0 where both are
/// exact, as at tilt 0.
std::vector<double> deviation(const PointResult& mc, const PointResult& wave);

/// The datasets of a shard, under the names that they have in the result of a sweep.
void write_point(ResultFile& file, const PointResult& point, const Scene& scene);
/// Throws InputError.
PointResult read_point(const ResultReader& file);

}  // namespace flatspeckle::apps
