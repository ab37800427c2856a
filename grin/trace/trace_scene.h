#pragma once

#include "grin/trace/curve_search.h"
#include "grin/trace/ray_bodies.h"
#include "grin/trace/ray_image.h"
#include "grin/trace/ray_tracing.h"

namespace flatspeckle::grin {

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

FoundConnections find_connections(const TraceScene& scene, std::uint64_t seed);
/// Each curve as a ray of its length, for its points.
std::vector<TracedRay> rays_along(const TraceScene& scene, const FoundConnections& found);

}  // namespace flatspeckle::grin
