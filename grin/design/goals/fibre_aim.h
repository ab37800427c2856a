#pragma once

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/goal.h"

namespace flatspeckle::grin::design {

/// Rays of a fibre, which are to go along it at the same speed.
struct FibreValues {
  static constexpr const char* word = "equal_path";
  std::string modes = "all";
  std::int64_t ray_count = 400;
};

void add_keys(Keys& keys, FibreValues& values);

/// Rays from where they are farthest from the axis to where they are nearest: optical path over
/// length along the axis is to be the same for all. Throws InputError for a field that is no guide.
std::unique_ptr<Aim> make_aim(const Keys& keys, const FibreValues& values, const FieldForm& form);

}  // namespace flatspeckle::grin::design
