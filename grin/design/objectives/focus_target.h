#pragma once

#include <optional>

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/objectives/design_objective.h"

namespace flatspeckle::grin::design {

/// Scene keys of the goal `focus`: the beams of parallel light, and the distance from the centre of
/// the ball at which each beam should meet in a point.
struct FocusValues {
  static constexpr const char* word = "focus";
  std::optional<double> focus = {};
  double aperture = 1;
  std::int64_t directions = 50, rays_per_direction = 100;
};

void add_keys(Keys& keys, FocusValues& values);

/// Makes the design target: parallel light from each direction should meet in one point, which lies
/// on the line through the centre of the ball along that direction. Throws InputError if the field
/// is not a ball.
std::unique_ptr<DesignTarget> make_target(const Keys& keys, const FocusValues& values,
                                          const FieldForm& form);

}  // namespace flatspeckle::grin::design
