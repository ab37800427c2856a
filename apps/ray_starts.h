#pragma once

#include <string>
#include <vector>

#include "apps/command_line.h"
#include "grin/fields/vec3.h"

namespace flatspeckle::apps {

/// Where rays start, as the user writes it.
struct RayStartSpec {
  std::string light = "line", rays;
  std::int64_t ray_count = 11;
  std::vector<double> origin = {0, 0, 0}, direction = {0, 0, 1}, across = {1, 0, 0};
  double beam_radius = 1, half_angle = 0.1;
};

struct RayStart {
  grin::Vec3 x, direction;  ///< direction of length 1
};

void add_ray_start_options(Options& options, RayStartSpec& spec);

/// Throws InputError, also for keys that the light has no use for.
std::vector<RayStart> make_ray_starts(const Subcommand& command, const RayStartSpec& spec);

}  // namespace flatspeckle::apps
