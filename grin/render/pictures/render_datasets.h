#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/numbers/statistics.h"
#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "grin/render/methods/render_scene.h"
#include "grin/render/pictures/decay_results.h"
#include "grin/render/pictures/powers_within.h"
#include "grin/render/pictures/render_job.h"
#include "grin/render/pictures/sideband_results.h"

namespace flatspeckle::grin {

/// Derivatives of the results of a sensor, [parameter][entry], by parameters of the medium
/// (path_score.h), then of the field (moving_paths.h). Errors of derivatives by the field include
/// the bias due to smoothed pixel edges (sensor_edges.h), as far as it exceeds the statistical
/// error.
struct PowerGradients {
  Estimate image, mean;
  Estimate within = {};  ///< derivatives of PowersWithin, for sensors that list radii
};

/// Returns the derivatives of a sensor. first_pixel: first pixel of the sensor in the sums of a
/// batch, which must contain derivatives.
PowerGradients power_gradients(const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins,
                               const GroupedSums& sums);

/// Names of the parameters of the derivatives.
std::vector<std::string> gradient_names(const RenderScene& scene);

extern const DatasetTable energy_table;

/// Returns the power by Termination; nullopt if the method traces no light paths to their ends.
std::optional<Estimate> energy_result(const RenderJob& job, const GroupedSums& sums);

/// Invariant: the power of all terminations equals the emitted power, if light paths are traced to
/// their ends.
Invariant power_balance(const RenderJob& job, const GroupedSums& sums);

/// Writes the terminations that are possible in the scene.
void write_energy(ResultFile& file, const RenderScene& scene, const RenderRequest& request,
                  const Estimate& energy);

extern const DatasetTable render_table;

/// Results of a sensor; results that are not requested are empty.
struct SensorResult {
  RenderedPicture picture;
  Estimate mean;                       ///< mean over the pixels
  std::optional<Estimate> total = {};  ///< power on the sensor, if its kind has a total
  std::optional<PowersWithin> within = {};
  std::optional<PowerGradients> gradients = {};
  std::optional<DecayResult> decay = {};
  std::optional<SidebandResult> sidebands = {};
  /// Total power, or the mean if there is no total, in each bin of optical path, and before and
  /// after all bins.
  Estimate pulse = {}, pulse_before = {}, pulse_after = {};
  /// Mean and mean squared optical path: pixel_paths, [pixel][2], of the light in each pixel;
  /// paths, of the light in all pixels.
  Estimate pixel_paths = {}, paths = {};
};
/// Results by sensor.
using RenderResult = std::vector<SensorResult>;
RenderResult render_result(const RenderScene& scene, const RenderJob& job, const GroupedSums& sums);

/// Writes pictures, means and totals. Each of several sensors has a group, sensors/NAME.
/// length_unit: metres per unit of length.
void write_render(ResultFile& file, const RenderScene& scene, const RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit);

/// Writes the counters of the cost of paths.
void write_counts(ResultFile& file, const TransportCounts& counts);

}  // namespace flatspeckle::grin
