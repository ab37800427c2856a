#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/run/runner.h"
#include "flatland/scene/scene.h"
#include "mc/paths/speckle/field_plan.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Fields that were drawn, [realization][light][view], and what they are to be compared with.
struct DrawnFields {
  DrawingPlan plan;
  std::vector<Complex> field;
  Estimate intensity;  ///< E|u|^2 per channel, from light paths: without the noise of speckle
  Estimate siegert;    ///< what the autocorrelation should be, where it is formed
  double wall_s = 0, cpu_s = 0;  ///< of all runs
};

/// How many lights' paths, on how many threads.
struct DrawingSettings {
  ReversedPaths reversed = ReversedPaths::automatic;
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Surveys the scene's paths, chooses how to draw, tells `planned`, and draws. Throws Interrupted
/// once a signal has come (catch_interrupts).
DrawnFields draw_fields(const Scene& scene, const FieldDemand& demand,
                        const DrawingSettings& settings,
                        const std::function<void(const DrawingPlan&)>& planned);

extern const DatasetTable field_table;

/// Statistics of all fields (field_statistics.h). No autocorrelation where views are not equally
/// spaced.
struct FieldSummary {
  Estimate mean_contrast, circularity, autocorrelation;
  std::optional<Estimate> grain_width;  ///< in sines, or lengths
};

/// Writes axes, fields and their statistics. tilts: rotations of the light that make the light
/// axis, or none.
FieldSummary write_fields(ResultFile& file, const Scene& scene, const std::vector<double>& tilts,
                          const DrawnFields& drawn);

}  // namespace flatspeckle::mc
