#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/statistics.h"
#include "core/result/invariant.h"
#include "core/run/runner.h"
#include "grin/render/methods/render_scene.h"
#include "grin/render/pictures/picture_errors.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

struct LightCheck;

/// A render that is divided into batches. A sample is one light path and one path from each sensor.
/// The sums of a batch, with imaginary part 0, are: [pixel][TimeBins::sums], sensor after sensor;
/// then [Termination], if light paths are traced to their ends; then TransportCounts; then the
/// means over the pixels of each sensor, and what independent estimates of them exceed them by
/// (LightCheck); then the sums of a map (MapKernel); then the steady pictures [pixel], if a pixel
/// has several sums; and last the control variates (ControlVariates).
struct RenderJob {
  BatchJob batches;
  TimeBins bins;
  std::size_t pictures = 0;  ///< number of sums of all pixels
  bool has_energy = false;   ///< whether there are sums by Termination
  std::size_t controls = 0;  ///< number of control variates
  std::string plan;          ///< method and features, as text
  std::size_t sensors = 0;
  std::size_t first_of_counts() const { return pictures + (has_energy ? EnergyBalance::size : 0); }
  std::size_t first_of_checks() const { return first_of_counts() + TransportCounts::size; }
  std::size_t first_of_map() const { return first_of_checks() + 2 * sensors; }
  std::size_t pixels() const { return pictures / static_cast<std::size_t>(bins.sums()); }
  bool keeps_steady() const { return bins.sums() > 1; }
  std::size_t first_of_steady() const {
    return keeps_steady() ? batches.size - controls - pixels() : 0;
  }
  /// Estimates pictures by jackknife(), with the control variates, the last of the sums, if there
  /// are any. few: effective number of groups below which an entry is undersampled.
  Estimate estimate(const GroupedSums& sums, const Estimator& theta,
                    double few = few_of_values) const;
  /// Estimates means or powers of one sensor. Where light paths hit the sensor often enough, the
  /// difference between the two estimates of its mean (LightCheck) is a further control variate, so
  /// that the better of the two determines the error.
  Estimate estimate_of(const LightCheck& check, const GroupedSums& steady,
                       const Estimator& theta) const;
  /// Index of the first pixel in steady_sums().
  std::size_t first_steady() const { return 2 * sensors; }
  bool pixels_have_neighbours = false;  ///< those which bound_errors() considers
  double few_of_pictures(const GroupedSums& sums) const {
    return pixels_have_neighbours ? few_of_pixels(sums.groups()) : few_of_values;
  }
};

/// Returns those sums from which means and powers of sensors are estimated: those of LightCheck,
/// the steady pictures and the control variates.
GroupedSums steady_sums(const RenderJob& job, const GroupedSums& sums);

/// Counters of all batches in the sums, including those of resumed runs.
TransportCounts transport_counts(const RenderJob& job, const GroupedSums& sums);

/// Invariant of a sensor that light can hit: the mean over its pixels, by all strategies with MIS,
/// equals the mean from light paths that hit it, without MIS. Path tracing has no light paths, and
/// is compared with some paths of bidirectional tracing instead. `off` is the difference of the two
/// means; `limit` is five standard errors of the difference plus one standard error of the mean.
/// Both are 0 if too few paths hit.
struct LightCheck : Invariant {
  double mean = 0, other = 0;
  std::size_t difference = 0;  ///< index of the difference in steady_sums()
  /// Whether the difference is a control variate: enough paths hit the sensor, and the two means
  /// agree but differ by more than rounding.
  bool is_control = false;
};
/// Returns the check of each sensor.
std::vector<LightCheck> light_checks(const RenderJob& job, const GroupedSums& sums);
/// Returns the worst of the checks that have enough paths, relative to the light that hits the
/// sensor; nullopt if none has.
std::optional<Invariant> worst_light(const std::vector<LightCheck>& checks);

/// Returns what target_error applies to by default: powers if the sensor lists radii, the total of
/// a sensor of one pixel, else the picture.
RenderTarget usual_target(const Sensor& sensor);

/// Returns the mean over the pixels of a sensor. first_pixel: number of its first pixel; steady:
/// steady_sums().
Estimate sensor_mean(const RenderJob& job, const GroupedSums& steady, const LightCheck& check,
                     std::size_t first_pixel, const SensorPixels& pixels);

/// Throws InputError for lights and sensors that do not fit the stage, for media in which paths
/// take too long to end, and for a random phase of a field without sound.
void check(const RenderScene& scene, const RenderRequest& request);

/// Checks the scene and plans the render by pilot runs. Throws InputError.
RenderJob render_job(const RenderScene& scene, const RenderRequest& request, std::uint64_t seed);

/// Values and standard errors of the pixels of all sensors: bins, by [pixel][bin]; steady, the sum
/// over optical paths; and, if there are several bins, the light before and after all of them.
struct RenderedPicture {
  Estimate bins, steady, before = {}, after = {};
};
RenderedPicture rendered_picture(const RenderJob& job, const GroupedSums& sums);

}  // namespace flatspeckle::grin
