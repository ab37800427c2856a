#pragma once

#include <string>
#include <vector>

#include "grin/media/fields/scene_field.h"
#include "grin/render/methods/field_parameter.h"

namespace flatspeckle::grin {

/// The fields beside that of the values, for derivatives by these of their keys; name.2 is the
/// third number of a key of several. Throws InputError (gradient_by) for what is no number of the
/// field, or 0.
std::vector<FieldParameter> field_parameters(const IndexFieldValues& values,
                                             const std::vector<std::string>& names,
                                             const FieldUse& use);

}  // namespace flatspeckle::grin
