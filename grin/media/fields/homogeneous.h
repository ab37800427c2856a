#pragma once

#include "grin/media/index/field_kind.h"

namespace flatspeckle::grin {

inline FieldFacts facts(const Homogeneous&) {
  return {.strength = 0};
}

struct HomogeneousValues {
  using Field = Homogeneous;
  static constexpr const char* word = "homogeneous";
  static constexpr bool is_medium = true;
  double index = 1;
};

inline void add_keys(Keys& keys, HomogeneousValues& values) {
  add_index_key(keys, values.index,
                "everywhere; also the background index of a sum of fields that includes no medium");
}

inline Homogeneous make_field(const Keys& keys, const HomogeneousValues& values, const FieldUse&) {
  return {keys.read(values.index) - 1};
}

}  // namespace flatspeckle::grin
