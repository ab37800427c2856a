#pragma once

#include <optional>
#include <vector>

#include "grin/media/index/index_field.h"
#include "grin/render/stage/stage.h"
#include "grin/render/values/field_body.h"
#include "grin/render/values/plain_bodies.h"

namespace flatspeckle::grin {

/// The stage of light and the bodies in it as keys have them.
struct StageValues : FieldBodyValues {
  std::vector<double> stage_box{}, stage_sphere{};
  MediumValues medium{}, body_medium{};
  PlainBodyValues plain_bodies{};
};

void add_keys(Keys& keys, StageValues& values);

/// A stage and the index field that light meets in it.
struct FilledStage {
  Stage stage;
  SceneField field;
  IndexRange index = {};
  FieldUse use = {};  ///< what the field was made for
};

/// A Luneburg ball in a larger stage is a body by itself. Throws InputError, also for a field that
/// has no index above 0 somewhere in its part of the stage.
FilledStage make_stage(const Keys& keys, const StageValues& values, const IndexFieldValues& field,
                       bool any_phase, const std::optional<double>& length_unit);

}  // namespace flatspeckle::grin
