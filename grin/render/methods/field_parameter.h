#pragma once

#include <string>

#include "grin/media/fields/any_index_field.h"

namespace flatspeckle::grin {

/// A number of the index field, and the fields with a little less and more of it.
struct FieldParameter {
  std::string name;
  double scale;  ///< what counts as a whole of it: its size, or 1
  double step;
  AnyIndexField less, more;
};

}  // namespace flatspeckle::grin
