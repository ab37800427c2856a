#include "grin/trace/trace_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numbers/memory.h"

namespace flatspeckle::grin {

namespace {

/// Of a light's rays: starts, ends and columns, and points twice, as rays and as columns.
void check_memory(const TraceValues& values) {
  if (!values.starts.rays.empty()) return;
  constexpr double ray = 600, point = 2 * sizeof(Vec3);
  const double points = static_cast<double>(values.path_points);
  const double bytes = static_cast<double>(values.starts.ray_count) * (ray + point * points);
  const double memory = usable_memory();
  if (bytes > 0.8 * memory)
    throw InputError("ray_count", values.starts.ray_count,
                     "with path_points = " + std::to_string(values.path_points) + " needs " +
                         std::to_string(bytes / 1e9) + " GB of memory; there are " +
                         std::to_string(memory / 1e9));
}

/// Where rays start, or curves start and end.
std::vector<Vec3> points_of(const TraceScene& scene) {
  if (scene.curves) return {scene.curves->from, scene.curves->to};
  std::vector<Vec3> points;
  for (const RayStart& start : scene.starts) points.push_back(start.x);
  return points;
}

std::vector<Surface> surfaces_of(const Stage& stage) {
  std::vector<Surface> surfaces;
  for (const Body& body : stage.bodies) surfaces.push_back(body.surface);
  return surfaces;
}

void settle_field(TraceScene& scene, const Keys& keys, const TraceValues& values) {
  double reach = keys.required(values.stops.max_length), farthest = 0;
  for (const Vec3& x : points_of(scene)) {
    reach = std::max(reach, std::hypot(x[0], x[1]));
    farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
  }
  scene.field = make_scene_field(keys, values.field,
                                 {.reach = reach, .length_unit = keys.read(values.length_unit)});
  if (scene.curves)
    scene.curves->ball = std::exchange(scene.field.rim, std::nullopt);
  else
    scene.stage = make_ray_stage(keys, values.bodies, scene.field);
  scene.stops =
      make_ray_stops(keys, values.stops, scene.field.scale, farthest, surfaces_of(scene.stage));
}

/// Curves want shorter steps than rays, by default.
void settle_steps(TraceScene& scene, const Keys& keys, const TraceValues& values) {
  if (!scene.curves) {
    scene.steps = make_ray_steps(keys, values.stops, scene.field.scale);
    return;
  }
  double step = curve_step(keys, values.stops, scene.field.scale / 100);
  if (!values.stops.step) step /= largest_index(scene.field, *scene.curves);
  scene.steps = {Sharma(), step};
}

}  // namespace

void add_keys(Keys& keys, TraceValues& values) {
  add_keys(keys, values.field);
  add_keys(keys, values.bodies);
  add_keys(keys, values.starts);
  add_keys(keys, values.curves);
  add_keys(keys, values.stops);
  add_keys(keys, values.image);
  keys.group("Result");
  keys.add("path_points", values.path_points,
           "Points of each ray in the file, to be drawn, and an index map; 0: none")
      .from(0, 100'000);
  keys.add("length_unit", values.length_unit, "What lengths are in, um or 1e-6, for times")
      .positive()
      .unit("m");
}

TraceScene make_trace_scene(const Keys& keys, const TraceValues& values) {
  TraceScene scene;
  scene.length_unit = keys.read(values.length_unit);
  scene.path_points = static_cast<std::size_t>(keys.read(values.path_points));
  if (scene.path_points == 1)
    throw InputError("path_points", 1, "must be 0 or at least 2: of the first point and the last");
  scene.curves = make_curve_search(keys, values.curves);
  if (!scene.curves) {
    check_memory(values);
    scene.starts = make_ray_starts(keys, values.starts);
    scene.image = make_image_plane(keys, values.image);
  }
  settle_field(scene, keys, values);
  settle_steps(scene, keys, values);
  return scene;
}

TraceScene make_trace_scene(const TraceValues& values) {
  return made_of(
      values, [](const Keys& keys, const TraceValues& all) { return make_trace_scene(keys, all); });
}

std::vector<TracedRay> trace_rays(const TraceScene& scene) {
  return trace_rays(scene.field, scene.stage, scene.stops, scene.steps, scene.starts,
                    scene.path_points);
}

FoundConnections find_connections(const TraceScene& scene, std::uint64_t seed) {
  return find_connections(scene.field, scene.stops, scene.steps.longest, *scene.curves, seed);
}

std::vector<TracedRay> rays_along(const TraceScene& scene, const FoundConnections& found) {
  std::vector<TracedRay> rays;
  for (const auto& [curve, times] : found.curves) {
    const RayStops stops{{}, curve.arc_length, 1e-12 * curve.arc_length};
    const RayStart start{scene.curves->from, curve.start_direction};
    rays.push_back(
        trace_rays(scene.field, scene.stage, stops, scene.steps, {start}, scene.path_points)[0]);
  }
  return rays;
}

}  // namespace flatspeckle::grin
