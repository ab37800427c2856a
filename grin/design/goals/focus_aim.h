#pragma once

#include <optional>

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/goal.h"

namespace flatspeckle::grin::design {

/// Parallel light from all around, and where it is to meet.
struct FocusValues {
  static constexpr const char* word = "focus";
  std::optional<double> focus = {};
  double aperture = 1;
  std::int64_t directions = 50, rays_per_direction = 100;
};

void add_keys(Keys& keys, FocusValues& values);

/// Each direction's light is to meet in a point on the line through the centre along it. Throws
/// InputError for a field that is no ball.
std::unique_ptr<Aim> make_aim(const Keys& keys, const FocusValues& values, const FieldForm& form);

}  // namespace flatspeckle::grin::design
