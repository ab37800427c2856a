#pragma once

#include "core/keys/keys.h"
#include "grin/design/forms/field_form.h"

namespace flatspeckle::grin::design {

/// What is sought, as keys have it.
struct FormValues {
  std::string design = "ball";
  double radius = 1;
  std::vector<std::int64_t> nodes{5, 9, 17};
  std::int64_t coefficients = 8;
  double start_excess = 0, least_index = 0.5, most_index = 3;
  double index = 1.5;
  std::optional<double> delta = {};
};

void add_keys(Keys& keys, FormValues& values);

/// The field that a search starts from, and how it may change.
struct FormStart {
  FieldForm form;                    ///< of the first level
  int levels = 1;                    ///< each with half the spacing of the one before
  double finest = 1;                 ///< nodes along an axis, of the last
  std::vector<double> coefficients;  ///< of the first
  double least_index, most_index;
};
/// Throws InputError.
FormStart make_form(const Keys& keys, const FormValues& values);

}  // namespace flatspeckle::grin::design
