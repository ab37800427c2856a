#pragma once

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/objectives/design_objective.h"

namespace flatspeckle::grin::design {

/// Scene keys of the goal `deflections`: rays whose directions behind the field were measured.
struct DeflectionValues {
  static constexpr const char* word = "deflections";
  std::string measured{};
};

void add_keys(Keys& keys, DeflectionValues& values);

/// Makes the design target: the rays should have the measured directions. Every tenth ray is used
/// for validation instead of the search. Throws InputError if too few rays pass through the field.
std::unique_ptr<DesignTarget> make_target(const Keys& keys, const DeflectionValues& values,
                                          const FieldForm& form);

}  // namespace flatspeckle::grin::design
