#include "grin/render/values/field_parameters.h"

#include <cmath>

#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle::grin {

namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw InputError("gradient_by", name, why);
}

/// One number of a key.
struct FieldNumber {
  std::string key;
  std::size_t which = 0;
  std::vector<std::string> texts;  ///< all numbers of the key

  double value() const { return read_number(texts[which]).value_or(0); }
};

/// The key as one of the field's kinds has been given it: others of its name are at their defaults.
const Key* key_of(const Keys& keys, const std::string& name) {
  const Key* found = nullptr;
  for (const Key& key : keys.rows())
    if (key.name() == name && (!found || key.given())) found = &key;
  return found;
}

FieldNumber number_of(const Keys& keys, const std::string& name) {
  const auto dot = name.find('.');
  FieldNumber number{name.substr(0, dot), 0, {}};
  const Key* const key = key_of(keys, number.key);
  if (!key || !key->is_number() || key->is_whole() || key->value().empty())
    refuse(name,
           "must be a number that the index field is given, as amplitude or transducer.2 "
           "(derivatives by mu_s, mu_a and g are those of gradient)");
  number.texts = key->value();
  const bool has_part = dot != std::string::npos;
  const auto part = has_part ? read_whole_number(name.substr(dot + 1)) : std::optional(0L);
  if (!part || *part < 0 || static_cast<std::size_t>(*part) >= number.texts.size() ||
      has_part != (number.texts.size() > 1))
    refuse(name, "is a key of " + std::to_string(number.texts.size()) + " numbers: " + number.key +
                     ".0 is the first of several");
  number.which = static_cast<std::size_t>(*part);
  return number;
}

AnyIndexField field_with(const IndexFieldValues& values, FieldNumber number, double value,
                         const FieldUse& use) {
  const Keyed<IndexFieldValues> keyed(values);
  number.texts[number.which] = number_text(value);
  keyed.keys.set(number.key, number.texts);
  const SceneField made = make_scene_field(keyed.keys, keyed.values, use);
  keyed.keys.refuse_unread();
  return made.field;
}

}  // namespace

std::vector<FieldParameter> field_parameters(const IndexFieldValues& values,
                                             const std::vector<std::string>& names,
                                             const FieldUse& use) {
  constexpr double apart = 1e-5;
  const Keyed<IndexFieldValues> keyed(values);
  std::vector<FieldParameter> parameters;
  for (const std::string& name : names) {
    const FieldNumber number = number_of(keyed.keys, name);
    const double value = number.value(), scale = value == 0 ? 1 : std::abs(value);
    const double step = apart * scale;
    parameters.push_back({name, scale, step, field_with(values, number, value - step, use),
                          field_with(values, number, value + step, use)});
  }
  return parameters;
}

}  // namespace flatspeckle::grin
