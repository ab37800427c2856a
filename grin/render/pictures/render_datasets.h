#pragma once

#include <optional>

#include "core/result/dataset_row.h"
#include "grin/render/pictures/power_gradients.h"
#include "grin/render/pictures/powers_within.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin {

extern const DatasetTable energy_table;

/// By Fate; nothing where the method walks no light path to its end.
std::optional<Estimate> energy_result(const RenderJob& job, const GroupedSums& sums);

/// Those fates that the scene has.
void write_energy(ResultFile& file, const RenderScene& scene, const RenderRequest& request,
                  const Estimate& energy);

extern const DatasetTable render_table;

/// What a sensor has found. Empty: was not asked for.
struct SensorResult {
  RenderedPicture picture;
  Estimate mean;                       ///< over the pixels
  std::optional<Estimate> total = {};  ///< a power, where the kind of sensor has it
  std::optional<PowersWithin> within = {};
  std::optional<PowerGradients> gradients = {};
  /// Mean or total by bin and beyond the bins.
  Estimate pulse = {}, pulse_before = {}, pulse_after = {};
  /// Mean optical path and mean of its square, [pixel][2], and of all pixels.
  Estimate pixel_paths = {}, paths = {};
};
/// Of all sensors.
using RenderResult = std::vector<SensorResult>;
RenderResult render_result(const RenderScene& scene, const RenderJob& job, const GroupedSums& sums);

/// Pictures, what they add up to, and what the paths cost. Of several sensors each has a group,
/// sensors/NAME. length_unit: metres.
void write_render(ResultFile& file, const RenderScene& scene, const RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit);

/// Whether curves between two points had to be sought.
bool has_trials(const RenderJob& job);

}  // namespace flatspeckle::grin
