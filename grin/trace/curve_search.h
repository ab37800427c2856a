#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "grin/media/fields/scene_field.h"
#include "grin/rays/connections/connection.h"
#include "grin/rays/marching/ray_stops.h"

namespace flatspeckle::grin {

/// The curves between two points as keys have them.
struct CurveValues {
  std::vector<double> connect{};
  std::int64_t trials = 1000;
};

void add_keys(Keys& keys, CurveValues& values);

struct CurveSearch {
  Vec3 from, to;
  std::uint64_t trials;
  std::optional<Sphere> ball = {};  ///< that curves stay in: a field's rim
};

/// Nothing without `connect`. Throws InputError.
std::optional<CurveSearch> make_curve_search(const Keys& keys, const CurveValues& values);

/// On the straight line between the points, as far as there is an index; 1 where there is none.
double largest_index(const SceneField& scene, const CurveSearch& search);

struct FoundConnections {
  std::vector<FoundConnection> curves;  ///< by optical path
  ConnectionStatistics statistics;
};

/// Curves of steps of that length at the most that stay on the side of every stop surface, and
/// within the ball or grid, that both points are on. Throws InputError.
FoundConnections find_connections(const SceneField& scene, const RayStops& stops, double step,
                                  const CurveSearch& search, std::uint64_t seed);

}  // namespace flatspeckle::grin
