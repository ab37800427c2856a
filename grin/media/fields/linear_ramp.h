#pragma once

#include "grin/media/index/field_kind.h"
#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// Index field with a constant gradient: n = 1 + excess_at_origin + slope . x. The index is
/// positive only on one side of a plane.
struct LinearRamp {
  double excess_at_origin;
  Vec3 slope;

  double excess(const Vec3& x) const { return excess_at_origin + slope.dot(x); }
  IndexGradient gradient(const Vec3& x) const { return {excess(x), slope}; }
  void gradients(const LaneVectors& x, LaneGradients& found) const {
    const double at_origin = excess_at_origin, sx = slope[0], sy = slope[1], sz = slope[2];
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      found.excess[k] = at_origin + (sx * x.x[k] + sy * x.y[k] + sz * x.z[k]);
      found.gradient.x[k] = sx;
      found.gradient.y[k] = sy;
      found.gradient.z[k] = sz;
    }
  }
  IndexHessian hessian(const Vec3& x) const {
    return {excess(x), slope, Mat3::Zero()};
  }
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
