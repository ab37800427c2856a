#pragma once

#include "grin/index/field_kind.h"

namespace flatspeckle::grin {

/// n = 1 + excess_at_origin + slope.x: positive on one side of a plane only.
struct LinearRamp {
  double excess_at_origin;
  Vec3 slope;

  double excess(const Vec3& x) const { return excess_at_origin + slope.dot(x); }
  IndexGradient gradient(const Vec3& x) const { return {excess(x), slope}; }
  IndexHessian hessian(const Vec3& x) const { return {excess(x), slope, Mat3::Zero()}; }
};

inline FieldFacts facts(const LinearRamp& field) {
  const double steepness = field.slope.norm();
  if (!(steepness > 0)) return {};
  return {
      .scale = 1 / steepness, .symmetry = Symmetry::stratified, .axis = field.slope.normalized()};
}

struct LinearValues {
  using Field = LinearRamp;
  static constexpr const char* word = "linear";
  static constexpr bool is_medium = false;
  double index = 1;
  std::vector<double> slope{0, 0, 0};
};

inline void add_keys(Keys& keys, LinearValues& values) {
  add_index_key(keys, values.index, "at the origin");
  add_vector(keys, "slope", values.slope, "Gradient of the index").unit("1/length");
}

inline LinearRamp make_field(const Keys& keys, const LinearValues& values, const FieldUse& use) {
  return {background(keys, values.index, use), vector_of(keys.read(values.slope))};
}

}  // namespace flatspeckle::grin
