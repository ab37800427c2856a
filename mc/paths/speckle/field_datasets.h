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

/// Sampled speckle fields, [realization][change or light][view], and reference values for their
/// statistics.
struct DrawnFields {
  DrawingPlan plan;
  FieldChanges changes;
  std::optional<LensPlane> image;  ///< set if the views are the pixels of an image
  std::vector<Complex> field;
  /// E|u|^2 of the field u in each channel, estimated from light paths and so without the noise of
  /// speckle
  Estimate intensity;
  /// Expected autocorrelation of the intensity (siegert_relation()); empty if it does not apply
  Estimate siegert;
  double wall_s = 0, cpu_s = 0;  ///< total times of all runs
};

/// Settings of the runs that draw fields.
struct DrawingSettings {
  ReversedPaths reversed = ReversedPaths::automatic;
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Measures the statistics of the light paths of the scene in a pilot run (PathSurvey), selects a
/// method, calls `planned` with the plan, and draws the fields. Throws Interrupted after a signal
/// (catch_interrupts).
DrawnFields draw_fields(const Scene& scene, const FieldDemand& demand,
                        const DrawingSettings& settings,
                        const std::function<void(const DrawingPlan&)>& planned);

extern const DatasetTable field_table;

/// Statistics of all fields (field_statistics.h). If views are not equally spaced,
/// `autocorrelation` is empty and there is no grain width.
struct FieldSummary {
  Estimate mean_contrast, circularity, autocorrelation;
  /// Width of a speckle grain, as a difference of sines of angles (far views) or as a length (near
  /// sensors)
  std::optional<Estimate> grain_width;
};

/// Writes axes, fields and their statistics.
FieldSummary write_fields(ResultFile& file, const Scene& scene, const DrawnFields& drawn);

}  // namespace flatspeckle::mc
