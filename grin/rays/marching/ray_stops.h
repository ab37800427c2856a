#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "grin/rays/marching/any_steps.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// Where rays end and how they are followed, as keys have it.
struct RayStopValues {
  std::vector<double> stop_plane{}, stop_sphere{}, stop_box{};
  std::optional<double> max_length = {}, step = {}, tolerance = {};
  std::string integrator = Sharma::word;
};

void add_keys(Keys& keys, RayStopValues& values);

/// Surfaces in the order planes, spheres, boxes.
struct RayStops {
  std::vector<Surface> surfaces;
  double max_length = 0;
  double location = 0;  ///< to which ends are found; length
};

/// Both throw InputError. scale: over which the index varies, 0: nowhere; farthest: the largest
/// coordinate of where rays start, which sets their rounding; others: what they pass on their way.
RayStops make_ray_stops(const Keys& keys, const RayStopValues& values, double scale,
                        double farthest, std::span<const Surface> others = {});
RaySteps make_ray_steps(const Keys& keys, const RayStopValues& values, double scale);
/// In words.
std::string describe(const RaySteps& steps);
/// Of curves, which have equal steps of Sharma: the longest.
double curve_step(const Keys& keys, const RayStopValues& values, double scale);

}  // namespace flatspeckle::grin
