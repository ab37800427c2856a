#pragma once

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/objectives/design_objective.h"

namespace flatspeckle::grin::design {

/// Scene keys of the goal `equal_path`: all rays in a fibre should have the same group delay.
struct FibreValues {
  static constexpr const char* word = "equal_path";
  std::string modes = "all";
  std::int64_t ray_count = 400;
};

void add_keys(Keys& keys, FibreValues& values);

/// Makes the design target: all rays should have the same optical path per length along the axis.
/// Each ray is traced from its largest to its smallest distance from the axis. Throws InputError if
/// the field is not a guide.
std::unique_ptr<DesignTarget> make_target(const Keys& keys, const FibreValues& values,
                                          const FieldForm& form);

}  // namespace flatspeckle::grin::design
