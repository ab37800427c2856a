#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/command_line.h"
#include "grin/surfaces/signed_distance.h"

namespace flatspeckle::apps {

/// Where rays end and how they are followed, as the user writes it.
struct RayStopSpec {
  std::vector<double> planes, spheres, boxes;
  std::optional<double> max_length, step, tolerance;
  std::string integrator = "sharma";
};

/// Surfaces in the order planes, spheres, boxes.
struct RayStops {
  std::vector<grin::Surface> surfaces;
  double max_length = 0;
  double location;  ///< to which ends are found; length
};

/// Steps of equal length, or controlled by a tolerance.
struct RaySteps {
  std::string integrator;
  double longest;
  std::optional<double> tolerance;
};

void add_ray_stop_options(Options& options, RayStopSpec& spec);

/// All throw InputError. scale: over which the index varies, 0: nowhere; farthest: the largest
/// coordinate of where rays start, which sets their rounding.
RayStops make_ray_stops(const RayStopSpec& spec, double scale, double farthest);
double max_length_of(const RayStopSpec& spec);
RaySteps make_ray_steps(const RayStopSpec& spec, double scale);

}  // namespace flatspeckle::apps
