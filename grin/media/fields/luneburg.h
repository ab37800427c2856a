#pragma once

#include <cmath>

#include "grin/media/index/field_kind.h"
#include "grin/media/index/radial_field.h"

namespace flatspeckle::grin {

/// Luneburg lens [luneburg1944]: n^2 = 2 - r^2/a^2 from the centre to the rim r = a, 1 outside. The
/// gradient jumps at the rim, so that a ray should be stopped there and started again. The formula
/// is continued up to r = (1 + beyond) a. A tiny value of `beyond` allows rays to start on the rim.
/// If all rays are stopped at the rim, a value up to 0.4 keeps the index smooth for integration
/// steps that overshoot the rim.
struct LuneburgProfile {
  static constexpr bool goes_in_lanes = true;
  static constexpr double for_stops = 0.4;

  double radius = 1;
  double beyond = 1e-9;

  double excess(double u) const {
    const double q = u / (radius * radius);
    return is_inside(q) ? (1 - q) / (1 + std::sqrt(2 - q)) : 0;
  }
  RadialJet jet(double u) const {
    const double area = radius * radius, q = u / area;
    if (!is_inside(q)) return {0, 0, 0};
    const double n = std::sqrt(2 - q);
    return {(1 - q) / (1 + n), -1 / (2 * area * n), -1 / (4 * area * area * n * n * n)};
  }
  RadialSquare square(double u) const {
    const double area = radius * radius, q = u / area;
    if (!is_inside(q)) return {0, 0};
    return {(1 - q) / (1 + std::sqrt(2 - q)), -1 / area};
  }

 private:
  bool is_inside(double q) const { return q <= (1 + beyond) * (1 + beyond); }
};
using Luneburg = RadialField<LuneburgProfile, 3>;

/// Returns the field to use for rays that end on the sphere `end`. If this sphere lies within the
/// rim, the formula is continued beyond the rim, so that steps that overshoot meet a smooth index.
inline Luneburg smooth_within(const Luneburg& field, const Sphere& end) {
  const double radius = field.profile().radius, rounding = 1e-9 * radius;
  if ((end.centre - field.centre()).norm() + end.radius > radius + rounding) return field;
  return Luneburg({radius, LuneburgProfile::for_stops}, field.centre());
}

inline FieldFacts facts(const Luneburg& field) {
  const double radius = field.profile().radius;
  return {.scale = radius,
          .symmetry = Symmetry::sphere,
          .centre = field.centre(),
          .rim = Sphere{field.centre(), radius}};
}

struct LuneburgValues {
  using Field = Luneburg;
  static constexpr const char* word = "luneburg";
  static constexpr bool is_medium = true;
  double radius = 1;
  std::vector<double> centre{0, 0, 0};
};

inline void add_keys(Keys& keys, LuneburgValues& values) {
  keys.add("radius", values.radius, "Radius of the ball").positive().unit("length");
  add_vector(keys, "centre", values.centre, "Centre of the ball").unit("length");
}

inline Luneburg make_field(const Keys& keys, const LuneburgValues& values, const FieldUse&) {
  return Luneburg({keys.read(values.radius), LuneburgProfile::for_stops},
                  vector_of(keys.read(values.centre)));
}

}  // namespace flatspeckle::grin
