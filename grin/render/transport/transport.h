#pragma once

#include "grin/render/lights/light.h"
#include "grin/render/sensors/sensor.h"
#include "grin/render/stage/stage.h"
#include "grin/render/transport/depth_importance.h"
#include "grin/render/transport/path_vertex.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// Stage, lights, sensors and settings of the estimators. Rays and free flights are in Space.
struct Transport {
  Stage stage;
  StageLights lights;
  std::vector<SensorEnd> sensors;
  Strategies strategies = {};
  /// Importance by which light paths are split; null if they are not split (RenderPlan::deep).
  std::shared_ptr<const DepthImportance> depth = {};
  int max_scatterings = std::numeric_limits<int>::max();
  /// Thresholds of Russian roulette, by sensor. A connection whose expected contribution is below
  /// the threshold is made with probability expected contribution / threshold.
  std::vector<double> connection_levels = std::vector<double>(sensors.size());
  /// Thresholds of Russian roulette for connections to beams, by sensor.
  std::vector<double> beam_levels = connection_levels;
  bool absorbs = stage.absorbs();  ///< whether some medium absorbs
  /// Whether sensor paths start in the same pixels in every batch that has fewer paths than pixels.
  bool keeps_pixels = false;

  /// Number of pixels of all sensors.
  int pixels() const {
    int count = 0;
    for (const SensorEnd& sensor : sensors) count += sensor.pixels().count();
    return count;
  }

  /// EndPosition::choice of a light: 0 if the light covers the whole boundary, so that sensor paths
  /// hit it wherever they leave the stage. No path is connected to such a light.
  double light_choice(const EndPosition& end) const {
    return end.surrounds && !strategies.short_sensor ? 0 : 1;
  }

  const ScatteringMedium& medium(Part part) const { return stage.medium_in(part); }
  /// Returns the medium at a point, which may be that of a label.
  const ScatteringMedium& medium(const PathPoint& at) const {
    return stage.medium_in(at.part).at(at.x);
  }
};

}  // namespace flatspeckle::grin
