#pragma once

#include <cstdint>
#include <vector>

#include "apps/ray_stops.h"
#include "apps/scene_field.h"
#include "grin/connections/connection.h"

namespace flatspeckle::apps {

struct ConnectSpec {
  std::vector<double> connect;
  std::int64_t trials = 1000;
};

void add_connect_options(Options& options, ConnectSpec& spec);

struct FoundConnections {
  std::vector<grin::FoundConnection> curves;  ///< by optical path
  grin::ConnectionStatistics statistics;
};

/// On the straight line between the points, as far as there is an index. Throws InputError.
double largest_index(const SceneField& scene, const ConnectSpec& spec);

/// Curves that stay on the side of every stop surface, and within the ball or grid, that both
/// points are on. Throws InputError.
FoundConnections find_connections(const SceneField& scene, const RayStops& stops, double step,
                                  const ConnectSpec& spec, std::uint64_t seed);

}  // namespace flatspeckle::apps
