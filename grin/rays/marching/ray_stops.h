#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "grin/rays/marching/any_steps.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// Scene keys of the surfaces on which rays end, of their largest length and of the integration
/// steps.
struct RayStopValues {
  std::vector<double> stop_plane{}, stop_sphere{}, stop_box{};
  std::optional<double> max_length = {}, step = {}, tolerance = {};
  std::string integrator = Sharma::word;
};

void add_keys(Keys& keys, RayStopValues& values);

/// Conditions that end rays: stop surfaces, in the order planes, spheres, boxes, and the largest
/// arc length.
struct RayStops {
  std::vector<Surface> surfaces;
  double max_length = 0;
  /// Tolerance, as a length, to which the end of a ray is located along the ray.
  double location = 0;
};

/// Returns the conditions that end rays. scale: length over which the index varies; 0 for a uniform
/// index. farthest: largest coordinate of the start points, which determines the rounding. others:
/// further surfaces that rays cross. Throws InputError.
RayStops make_ray_stops(const Keys& keys, const RayStopValues& values, double scale,
                        double farthest, std::span<const Surface> others = {});
RaySteps make_ray_steps(const Keys& keys, const RayStopValues& values, double scale);
/// Returns a description of the integration steps for printed output.
std::string describe(const RaySteps& steps);
/// Returns the longest integration step for curves between two points. Curves use equal steps of
/// the integrator Sharma.
double curve_step(const Keys& keys, const RayStopValues& values, double scale);

}  // namespace flatspeckle::grin
