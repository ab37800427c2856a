#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line.h"
#include "apps/index_field_options.h"
#include "apps/light_options.h"
#include "apps/sensor_options.h"
#include "apps/stage_options.h"
#include "grin/estimators/render_job.h"

namespace flatspeckle::apps {

/// A picture as the user asks for it.
struct RenderSpec {
  IndexFieldSpec field;
  StageSpec stage;
  LightSpec lights;
  SensorSpec sensor;
  std::vector<double> path_bins;
  std::optional<double> length_unit, step, max_length, photon_radius;
  bool random_phase = false;
  std::string method = "bidirectional";
  std::int64_t max_scatterings = 0;
};

void add_render_options(Options& options, RenderSpec& spec);

/// All throw InputError.
grin::RenderScene make_render_scene(const Subcommand& command, const RenderSpec& spec);
grin::RenderRequest make_render_request(const RenderSpec& spec);
/// Metres in a unit of length, where the user said.
std::optional<double> length_unit_of(const RenderSpec& spec);

/// What the scene takes from files, each by name and checksum.
std::string inputs_text(const RenderSpec& spec);

}  // namespace flatspeckle::apps
