#pragma once

#include <cmath>

#include "core/numbers/wide/functions.h"
#include "grin/media/index/field_kind.h"
#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// A ramp of n - 1 from `low` to `high` along the unit vector `axis`. It follows tanh(d / width),
/// where d is the distance from the plane through `centre` perpendicular to `axis`.
struct TanhRamp {
  double low, high, width;
  Vec3 axis = Vec3::UnitZ(), centre = Vec3::Zero();

  double excess(const Vec3& x) const { return low + (high - low) * fractions(x).above; }
  IndexGradient gradient(const Vec3& x) const {
    const auto [below, above] = fractions(x);
    return {low + (high - low) * above, first(below, above) * axis};
  }
  void gradients(const LaneVectors& x, LaneGradients& found) const {
    const double base = low, rise = high - low, scale = 2 / width, middle = axis.dot(centre);
    const double ax = axis[0], ay = axis[1], az = axis[2];
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      const double t = scale * (ax * x.x[k] + ay * x.y[k] + az * x.z[k] - middle);
      // Fractions of `high` and `low` in the index; the larger one is 1/(1 + e)
      const double down = t < 0 ? t : -t, e = wide_exp(down);
      const double most = 1 / (1 + e), least = e * most;
      const double derivative = scale * rise * most * least;
      found.excess[k] = base + rise * (t < 0 ? least : most);
      found.gradient.x[k] = derivative * ax;
      found.gradient.y[k] = derivative * ay;
      found.gradient.z[k] = derivative * az;
    }
  }
  IndexHessian hessian(const Vec3& x) const {
    const auto [below, above] = fractions(x);
    const double derivative = first(below, above);
    const Mat3 hessian = 2 / width * (below - above) * derivative * axis * axis.transpose();
    return {low + (high - low) * above, derivative * axis, hessian};
  }

 private:
  struct Fractions {
    /// Fractions (1 - tanh)/2 and (1 + tanh)/2 of `low` and `high`, each without cancellation.
    double below, above;
  };
  Fractions fractions(const Vec3& x) const {
    const double t = 2 * axis.dot(x - centre) / width;
    return {1 / (1 + std::exp(t)), 1 / (1 + std::exp(-t))};
  }
  double first(double below, double above) const {
    return 2 / width * (high - low) * below * above;
  }
};

inline FieldFacts facts(const TanhRamp& field) {
  return {.scale = field.width / 2,
          .strength = std::abs(field.high - field.low),
          .places = {field.centre},
          .symmetry = Symmetry::stratified,
          .axis = field.axis};
}

struct TanhValues {
  using Field = TanhRamp;
  static constexpr const char* word = "tanh";
  static constexpr bool is_medium = false;
  std::optional<double> index_low = {}, index_high = {};
  double ramp_width = 1;
  std::vector<double> ramp_axis{0, 0, 1}, centre{0, 0, 0};
};

inline void add_keys(Keys& keys, TanhValues& values) {
  keys.add("index_low", values.index_low,
           "Index far from the ramp, on the side opposite to ramp_axis; in a sum of fields the "
           "ramp adds 0 on this side and index_high - index_low on the other")
      .positive();
  keys.add("index_high", values.index_high,
           "Index far from the ramp, on the side to which ramp_axis points")
      .positive();
  keys.add("ramp_width", values.ramp_width,
           "Width of the ramp: the index follows tanh(distance/width)")
      .positive()
      .unit("length");
  add_vector(keys, "ramp_axis", values.ramp_axis,
             "Direction from index_low to index_high, of any length");
  add_vector(keys, "centre", values.centre, "A point on the ramp's middle plane").unit("length");
}

inline TanhRamp make_field(const Keys& keys, const TanhValues& values, const FieldUse& use) {
  const double low = keys.required(values.index_low) - 1;
  const double high = keys.required(values.index_high) - 1;
  const double below = use.is_added ? low : 0;
  return {low - below, high - below, keys.read(values.ramp_width),
          direction_of(keys, values.ramp_axis), vector_of(keys.read(values.centre))};
}

}  // namespace flatspeckle::grin
