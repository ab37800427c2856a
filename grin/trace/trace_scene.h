#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "grin/media/fields/scene_field.h"
#include "grin/rays/connections/connection.h"
#include "grin/rays/marching/ray_stops.h"
#include "grin/trace/ray_bodies.h"
#include "grin/trace/ray_image.h"
#include "grin/trace/ray_tracing.h"

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

struct FoundConnections {
  std::vector<FoundConnection> curves;  ///< by optical path
  ConnectionStatistics statistics;
};

/// Rays through an index field, or the curves between two points of it, as keys have them.
struct TraceValues {
  IndexFieldValues field{};
  RayBodyValues bodies{};
  RayStartValues starts{};
  RayStopValues stops{};
  RayImageValues image{};
  CurveValues curves{};
  std::int64_t path_points = 0;
  double length_unit = 1;
};

void add_keys(Keys& keys, TraceValues& values);

struct TraceScene {
  SceneField field;
  Stage stage;  ///< of the bodies; its boundary stops nothing
  RayStops stops;
  RaySteps steps;
  std::vector<RayStart> starts = {};  ///< none where curves are sought
  std::optional<CurveSearch> curves = {};
  std::optional<ImagePlane> image = {};  ///< of rays
  std::size_t path_points = 0;           ///< of each ray or curve; 0: none
  double length_unit = 1;                ///< metres in a unit of length
};

/// Both throw InputError; of values alone, all must be of use.
TraceScene make_trace_scene(const Keys& keys, const TraceValues& values);
TraceScene make_trace_scene(const TraceValues& values);

std::vector<TracedRay> trace_rays(const TraceScene& scene);

/// Curves that stay on the side of every stop surface, and within the ball or grid, that both
/// points are on. Throws InputError.
FoundConnections find_connections(const TraceScene& scene, std::uint64_t seed);
/// Each curve as a ray of its length, for its points.
std::vector<TracedRay> rays_along(const TraceScene& scene, const FoundConnections& found);

}  // namespace flatspeckle::grin
