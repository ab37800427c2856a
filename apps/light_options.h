#pragma once

#include <optional>
#include <vector>

#include "apps/command_line.h"
#include "grin/ends/light.h"

namespace flatspeckle::apps {

/// The lights of a stage as the user writes them.
struct LightSpec {
  std::vector<double> points, beams, faces;
  std::optional<double> environment;
};

void add_light_options(Options& options, LightSpec& spec);

/// In the order points, beams, faces, environment. Throws InputError, also for no lights.
std::vector<grin::Light> make_lights(const LightSpec& spec);

}  // namespace flatspeckle::apps
