#pragma once

#include "grin/render/lights/light.h"
#include "grin/render/sensors/sensor.h"
#include "grin/render/stage/stage.h"
#include "grin/render/transport/depth_importance.h"
#include "grin/render/transport/path_vertex.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// What estimators are told of a scene, but for its space.
struct Transport {
  Stage stage;
  StageLights lights;
  std::vector<SensorEnd> sensors;
  Strategies strategies = {};
  /// Of plans that are deep.
  std::shared_ptr<const DepthImportance> depth = {};
  int max_scatterings = std::numeric_limits<int>::max();
  /// Of each sensor: joins that promise less than this are left to chance, in proportion to what
  /// they promise.
  std::vector<double> join_levels = std::vector<double>(sensors.size());
  std::vector<double> beam_levels = join_levels;  ///< of those to beams
  bool absorbs = stage.absorbs();                 ///< some medium does

  /// Of all sensors.
  int pixels() const {
    int count = 0;
    for (const SensorEnd& sensor : sensors) count += sensor.pixels().count();
    return count;
  }

  const ScatteringMedium& medium(Part part) const { return stage.medium_in(part); }
};

}  // namespace flatspeckle::grin
