#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/numbers/statistics.h"
#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "grin/render/methods/render_scene.h"
#include "grin/render/pictures/powers_within.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin {

/// Derivatives of what a sensor has found, by each parameter of the medium (path_score.h) and of
/// the field (moving_paths.h), one parameter after the other. Errors of the latter have what the
/// width of edges does, as far as it is told from chance.
struct PowerGradients {
  Estimate image, mean;
  Estimate within = {};  ///< of sensors that list radii (PowersWithin)
};

/// Of a sensor whose first pixel is that of a batch's sums; theirs have derivatives.
PowerGradients power_gradients(const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins,
                               const GroupedSums& sums);

/// What they are by.
std::vector<std::string> gradient_names(const RenderScene& scene);

extern const DatasetTable energy_table;

/// By Fate; nothing where the method walks no light path to its end.
std::optional<Estimate> energy_result(const RenderJob& job, const GroupedSums& sums);

/// Whether the power that ended in all fates together is the emitted one, where a light path is
/// walked to its end.
Invariant power_balance(const RenderJob& job, const GroupedSums& sums);

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

/// Pictures, and what they add up to. Of several sensors each has a group,
/// sensors/NAME. length_unit: metres.
void write_render(ResultFile& file, const RenderScene& scene, const RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit);

/// What the paths cost.
void write_counts(ResultFile& file, const TransportCounts& counts);

}  // namespace flatspeckle::grin
