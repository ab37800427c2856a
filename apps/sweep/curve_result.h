#pragma once

#include <vector>

#include "apps/sweep/curve_sweep.h"
#include "apps/sweep/point_journal.h"
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
  Trace trace;                                         ///< where it has an error
  double relative_error = 0, samples = 0, cpu_s = 0, wall_s = 0;
};

/// Of a run that has ended.
PointResult point_result(const Scene& scene, const FieldJob& job, const RunState& state);

/// The range as its curve is stepped through: in q.
mc::Range range_in_q(const Scene& scene, const PointResult& point);

/// Difference of the curves of two methods in combined standard errors, per tilt; 0 where both are
/// exact, as at tilt 0.
std::vector<double> deviation(const PointResult& mc, const PointResult& wave);

/// Puts down what the journal keeps of a point: all but the costs.
void write_point(ResultFile& file, const PointResult& point);
/// Throws InputError where it is not all there.
PointResult curve_of(const FinishedPoint& finished);

/// What the points gave that every method has finished.
struct CurveResults {
  std::vector<std::size_t> points;
  std::vector<std::vector<PointResult>> by_method;  ///< [method][point]
};

/// Axes, curves, ranges, theory, costs and traces of the finished points, as docs/format.md says:
/// on the sweep's own axes where all are there, else as a list. There must be one at least.
void write_sweep(ResultFile& file, const CurveSweep& sweep, const CurveResults& results);

/// The ranges of the finished points on standard output, if there are not too many, and notes on
/// standard error about those that rest on too few tilts.
void print_ranges(const CurveSweep& sweep, const CurveResults& results);

/// Writes the axes of a sweep and what else tells its points apart, and binds GRID, the axes that a
/// quantity per point stands on: those of the sweep, or, as a list, `point` alone. scenes: of the
/// points that are written, all of them unless as a list.
void write_sweep_grid(ResultFile& file, const CurveSweep& sweep, const std::vector<Scene>& scenes,
                      bool as_list);

}  // namespace flatspeckle::apps
