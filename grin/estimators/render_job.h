#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/run/runner.h"
#include "grin/connections/connection.h"
#include "grin/ends/light.h"
#include "grin/ends/sensor.h"
#include "grin/estimators/film.h"
#include "grin/estimators/transport_counts.h"
#include "grin/fields/any_index_field.h"
#include "grin/space/render_plan.h"
#include "grin/space/stage.h"

namespace flatspeckle::grin {

/// Everything that light meets.
struct RenderScene {
  AnyIndexField field;
  double step;        ///< of rays in sigma (length at index 1); no use in a homogeneous field
  double max_length;  ///< arc length of one flight or join; longer ones are lost
  bool random_phase = false;  ///< of a StandingWave: each path meets its own (C28)
  Stage stage;
  std::vector<Light> lights;
  std::vector<Sensor> sensors;
  std::vector<std::string> sensor_names = {};  ///< of several
  TimeBins bins = {};
  std::optional<double> length_unit = {};  ///< metres in a unit of length, for times
};

/// Of a scene with several sensors; a number where it has no names.
std::string sensor_name(const RenderScene& scene, std::size_t sensor);

enum class RenderMethod { path, light, bidirectional, photon_map };

struct RenderRequest {
  RenderMethod method = RenderMethod::bidirectional;
  std::int64_t max_scatterings = 0;  ///< 0: no limit
  double photon_radius = 0;          ///< of photon_map; 0: chosen from the scene
};

/// The least plan that a scene allows.
RenderPlan render_plan(const RenderScene& scene);

/// samples: light paths and as many paths of each sensor. Sums of a batch: [pixel][bin] with the
/// pixels of one sensor after the other, imaginary part 0.
struct RenderJob {
  BatchJob batches;
  TimeBins bins;
  std::string plan;  ///< what is left out and what is not
  /// Of all batches that have run here.
  std::shared_ptr<const TransportCounts> counts;
};

/// Throws InputError for lights and sensors that do not fit the stage, for media in which paths do
/// not end in time, and for a random phase of a field without sound.
void check(const RenderScene& scene, const RenderRequest& request);

/// Checks the same, then walks a few paths to plan. Throws InputError.
RenderJob render_job(const RenderScene& scene, const RenderRequest& request, std::uint64_t seed);

/// Value and standard error of [pixel][bin], and of the sum over the bins; of all sensors.
struct RenderedPicture {
  Estimate bins, steady;
};
RenderedPicture rendered_picture(const RenderJob& job, const GroupedSums& sums);

}  // namespace flatspeckle::grin
