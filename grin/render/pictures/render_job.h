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
#include "grin/render/sensors/pixel_grid.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// Groups of 256 that make up an error; what fewer do is marked. Of light paths that are worth as
/// unequal as in a graded fibre, values of fewer lie beyond two errors too often.
inline constexpr double few_of_values = 36;
/// Where neighbours have a say in it (bound_errors).
inline constexpr double few_of_pixels = 12;

/// Marks (Estimate::rare) of a picture [row][column][bin] that each entry has by itself become
/// those of neighbourhoods, and errors of marked entries upper bounds. An entry is marked where
/// most of it and its neighbours are, or those that are have most of the light: by itself an entry
/// looks surest that strong paths have missed by chance. Marked is also what no path has lit, which
/// is not known to be dark. The error of a marked entry is doubled, and is no less than what
/// contributions of the size that its neighbours have might have left out.
void bound_errors(Estimate& picture, const PixelGrid& grid);

/// samples: light paths and as many paths of each sensor. Sums of a batch, imaginary part 0:
/// [pixel][TimeBins::sums] with the pixels of one sensor after the other; then [fate], where light
/// paths are walked to their ends; then TransportCounts; then means over the pixels of each sensor,
/// and the same found in another way (LightCheck); then those of a map (MapKernel), and last a
/// control variate (DepthImportance::Drift).
struct RenderJob {
  BatchJob batches;
  TimeBins bins;
  std::size_t pictures = 0;  ///< sums of the pixels
  bool has_energy = false;   ///< sums by Fate
  bool has_drift = false;    ///< the last of the sums
  std::string plan;          ///< the method, what is left out and what is not
  std::size_t sensors = 0;
  std::size_t first_of_counts() const { return pictures + (has_energy ? EnergyBalance::size : 0); }
  std::size_t first_of_checks() const { return first_of_counts() + TransportCounts::size; }
  std::size_t first_of_map() const { return first_of_checks() + 2 * sensors; }
  /// Of pictures: jackknife(), with the control variate where there is one; what fewer than so many
  /// groups make up is marked.
  Estimate estimate(const GroupedSums& sums, const Estimator& theta,
                    double few = few_of_values) const;
  double few_of_pictures = few_of_values;
};

/// What the batches in the sums cost, also those of runs that this one resumes.
TransportCounts transport_counts(const RenderJob& job, const GroupedSums& sums);

/// An invariant of a sensor that light can hit: the mean over its pixels, by weights of all
/// strategies, is that of the light paths that hit it by themselves. Path tracing has none, and is
/// compared with some paths of bidirectional tracing. `off` is the difference, `limit` five of its
/// standard errors and one of the mean's; both are 0 where too few paths hit to tell.
struct LightCheck : Invariant {
  double mean = 0, other = 0;
};
/// Of each sensor.
std::vector<LightCheck> light_checks(const RenderJob& job, const GroupedSums& sums);
/// The worst of those that are known, relative to what hits the sensor.
std::optional<Invariant> worst_light(const std::vector<LightCheck>& checks);

/// Throws InputError for lights and sensors that do not fit the stage, for media in which paths do
/// not end in time, and for a random phase of a field without sound.
void check(const RenderScene& scene, const RenderRequest& request);

/// Checks the same, then walks a few paths to plan. Throws InputError.
RenderJob render_job(const RenderScene& scene, const RenderRequest& request, std::uint64_t seed);

/// Value and standard error of [pixel][bin], of what is before and after all bins where there are
/// several, and of the sum of all; of all sensors.
struct RenderedPicture {
  Estimate bins, steady, before = {}, after = {};
};
RenderedPicture rendered_picture(const RenderJob& job, const GroupedSums& sums);

}  // namespace flatspeckle::grin
