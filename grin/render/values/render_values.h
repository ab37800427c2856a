#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "grin/media/index/index_field.h"
#include "grin/render/pictures/render_job.h"
#include "grin/render/stage/stage.h"
#include "grin/render/values/field_body.h"
#include "grin/render/values/map_values.h"
#include "grin/render/values/tagging.h"

namespace flatspeckle::grin {

/// Values of the keys of the stage and its bodies.
struct StageValues : FieldBodyValues {
  std::vector<double> stage_box{}, stage_sphere{};
  MediumValues medium{}, body_medium{};
  PlainBodyValues plain_bodies{};
};

void add_keys(Keys& keys, StageValues& values);

/// A stage and its index field.
struct FilledStage {
  Stage stage;
  SceneField field;
  IndexRange index = {};
  FieldUse use = {};  ///< argument with which the field was made
};

/// Makes the stage; a Luneburg ball in a larger stage becomes a body. Throws InputError, also for a
/// field with an index that is not positive somewhere in its part of the stage.
FilledStage make_stage(const Keys& keys, const StageValues& values, const IndexFieldValues& field,
                       bool any_phase, const std::optional<double>& length_unit);

/// Values of the keys of a scene.
struct RenderValues {
  IndexFieldValues field{};
  StageValues stage{};
  LightValues lights{};
  SensorValues sensors{};
  std::vector<double> path_bins{};
  bool path_moments = false, gradient = false;
  std::vector<double> delays{}, diffusion{};
  TaggingValues tagging{};
  std::vector<std::string> gradient_by{};
  MapValues map{};
  std::optional<double> length_unit = {}, step = {}, max_length = {};
  bool random_phase = false;
};
/// Values of the keys of the method.
struct RenderRequestValues {
  std::string method = "auto", target = "auto";
  std::int64_t max_scatterings = 0;
};

void add_keys(Keys& keys, RenderValues& values);
void add_keys(Keys& keys, RenderRequestValues& values);

/// Make scene and request. All throw InputError; the overloads without keys also if a value is
/// given that is not used.
RenderScene make_render_scene(const Keys& keys, const RenderValues& values);
RenderScene make_render_scene(const RenderValues& values);
RenderRequest make_render_request(const Keys& keys, const RenderRequestValues& values);
RenderRequest make_render_request(const RenderRequestValues& values);

}  // namespace flatspeckle::grin
