#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "grin/render/pictures/render_job.h"
#include "grin/render/values/stage_values.h"

namespace flatspeckle::grin {

/// What a picture is of, as keys have it.
struct RenderValues {
  IndexFieldValues field{};
  StageValues stage{};
  LightValues lights{};
  SensorValues sensors{};
  std::vector<double> path_bins{};
  bool path_moments = false, gradient = false;
  std::vector<std::string> gradient_by{};
  std::vector<double> map_box{}, map_cylinder{};
  std::vector<std::int64_t> map_cells{};
  std::optional<double> length_unit = {}, step = {}, max_length = {};
  bool random_phase = false;
};
/// And how it is made.
struct RenderRequestValues {
  std::string method = "auto";
  std::int64_t max_scatterings = 0;
};

void add_keys(Keys& keys, RenderValues& values);
void add_keys(Keys& keys, RenderRequestValues& values);

/// All throw InputError; of values alone, all must be of use.
RenderScene make_render_scene(const Keys& keys, const RenderValues& values);
RenderScene make_render_scene(const RenderValues& values);
RenderRequest make_render_request(const Keys& keys, const RenderRequestValues& values);
RenderRequest make_render_request(const RenderRequestValues& values);

}  // namespace flatspeckle::grin
