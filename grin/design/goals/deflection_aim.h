#pragma once

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/goals/goal.h"

namespace flatspeckle::grin::design {

/// Rays whose directions behind the field were measured.
struct DeflectionValues {
  static constexpr const char* word = "deflections";
  std::string measured{};
};

void add_keys(Keys& keys, DeflectionValues& values);

/// Every tenth ray is held out. Throws InputError where no ray goes through the field.
std::unique_ptr<Aim> make_aim(const Keys& keys, const DeflectionValues& values,
                              const FieldForm& form);

}  // namespace flatspeckle::grin::design
