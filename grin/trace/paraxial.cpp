#include "grin/trace/paraxial.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "grin/media/geometry/frame.h"
#include "grin/rays/surfaces/straight_crossing.h"
#include "grin/render/stage/regions.h"

namespace flatspeckle::grin {

namespace {

/// Position and direction behind the system of a ray that starts at unit height, relative to the
/// axial ray and linearised about it, for two perpendicular directions. Both are taken in the plane
/// through the end of the axial ray, perpendicular to it.
struct Linear {
  std::array<Vec3, 2> place, direction;
};

/// Traces rays at `height` on both sides of the axis. Returns nullopt if the rays end in different
/// ways.
std::optional<Linear> linear_at(const TraceScene& scene, const TracedRay& axial, double height) {
  const ParallelBeam& beam = *scene.beam;
  const Frame frame = frame_across(beam.direction);
  std::vector<RayStart> starts;
  for (int axis = 0; axis < 2; ++axis)
    for (const double side : {1.0, -1.0})
      starts.push_back({beam.origin + side * height * frame.col(axis), beam.direction});
  const auto rays =
      trace_rays(scene.field, scene.stage, scene.stops, scene.steps, starts, 0, scene.apertures);
  const Vec3 along = axial.end.v.normalized();
  std::vector<Vec3> at, direction;
  for (const TracedRay& ray : rays) {
    if (ray.status != axial.status || ray.surface != axial.surface) return std::nullopt;
    direction.push_back(ray.end.v / along.dot(ray.end.v));
    at.push_back(ray.end.x + direction.back() * along.dot(axial.end.x - ray.end.x));
  }
  Linear linear;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    linear.place[axis] = (at[2 * axis] - at[2 * axis + 1]) / (2 * height);
    linear.direction[axis] = (direction[2 * axis] - direction[2 * axis + 1]) / (2 * height);
  }
  return linear;
}

/// Returns the distance from the end of the axial ray back to the last surface of a body; nullopt
/// if there is none.
std::optional<double> back_to_surface(const TraceScene& scene, const TracedRay& axial) {
  const Vec3 back = -axial.end.v.normalized();
  const Part part = Regions(scene.stage).at(axial.end.x, back);
  double length = no_crossing;
  if (part != around) length = exit_distance(scene.stage.surface(part), axial.end.x, back);
  // Bodies later in the list replace earlier ones where they overlap
  for (Part over = part + 1; over < scene.stage.parts(); ++over)
    length = std::min(length, entry_distance(scene.stage.surface(over), axial.end.x, back));
  return length < no_crossing ? std::optional(length) : std::nullopt;
}

std::optional<ParaxialSystem> system_of(const TraceScene& scene) {
  const ParallelBeam& beam = *scene.beam;
  constexpr double share = 0.02, least_power = 1e-12;
  const auto axial = trace_rays(scene.field, scene.stage, scene.stops, scene.steps,
                                {{beam.origin, beam.direction}}, 0, scene.apertures)[0];
  const double high = share * beam.radius;
  const auto coarse = linear_at(scene, axial, high), fine = linear_at(scene, axial, high / 2);
  if (!coarse || !fine) return std::nullopt;
  const Frame frame = frame_across(beam.direction);
  double angle = 0, distance = 0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    // Errors are proportional to the square of the height
    const Vec3 u = (4 * fine->direction[axis] - coarse->direction[axis]) / 3;
    const Vec3 h = (4 * fine->place[axis] - coarse->place[axis]) / 3;
    const double focus = -h.dot(u) / u.squaredNorm();
    const double along_start = frame.col(static_cast<Eigen::Index>(axis)).dot(u);
    // Behind mirrors that turn the light, the sign follows from the side of the focus
    const bool is_turned = !(std::abs(along_start) > 0.7 * u.norm());
    angle += (is_turned ? std::copysign(u.norm(), -focus) : along_start) / 2;
    distance += focus / 2;
  }
  if (!(std::abs(angle) * beam.radius > least_power) || !std::isfinite(distance))
    return std::nullopt;
  ParaxialSystem system{};
  system.focal_length = -1 / angle;
  system.image_index = axial.end.v.norm();
  system.power = system.image_index / system.focal_length;
  system.f_number = std::abs(system.focal_length) / (2 * beam.radius);
  system.focus = axial.end.x + distance * axial.end.v.normalized();
  if (const auto back = back_to_surface(scene, axial)) system.back_focal_length = *back + distance;
  return system;
}

}  // namespace

std::optional<ParaxialSystem> paraxial_system(const TraceScene& scene) try {
  return scene.beam ? system_of(scene) : std::nullopt;
} catch (const InputError&) {  // the axial ray is lost, for example where the system is obstructed
  return std::nullopt;
}

}  // namespace flatspeckle::grin
