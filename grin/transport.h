#pragma once

#include <cstdint>
#include <vector>

#include "grin/connection.h"
#include "grin/film.h"
#include "grin/light.h"
#include "grin/path_vertex.h"
#include "grin/sensor.h"
#include "grin/stage.h"

namespace flatspeckle::grin {

/// What estimators are told of a scene, but for its space.
struct Transport {
  Stage stage;
  Lights lights;
  SensorEnd sensor;
  Strategies strategies = {};
  int max_scatterings = std::numeric_limits<int>::max();
  /// Joins that promise less than this are left to chance, in proportion to what they promise.
  double join_level = 0;

  const ScatteringMedium& medium(Part part) const {
    return part == Part::body ? stage.body->medium : stage.medium;
  }
  /// Known to be met everywhere in a part; a grid may be empty.
  double least_extinction(Part part) const {
    return medium(part).density ? 0 : medium(part).mu_t();
  }
};

/// What a batch cost.
struct TransportCounts {
  std::uint64_t flights = 0, lost_flights = 0;
  std::uint64_t joins_weighed = 0, joins = 0;  ///< considered; asked of space
  std::uint64_t lost_values = 0;               ///< not finite; left out
  ConnectionStatistics connections = {};

  TransportCounts& operator+=(const TransportCounts& other) {
    flights += other.flights;
    lost_flights += other.lost_flights;
    joins_weighed += other.joins_weighed;
    joins += other.joins;
    lost_values += other.lost_values;
    connections += other.connections;
    return *this;
  }
};

}  // namespace flatspeckle::grin
