#pragma once

#include <span>
#include <variant>
#include <vector>

#include "grin/design/designed_field.h"

namespace flatspeckle::grin::design {

// What a sought field is but for its coefficients.

struct BallForm {
  Vec3 centre = Vec3::Zero();
  double radius = 1;
  int nodes = 5;  ///< along each axis of the cube

  FieldGrid grid() const {
    const double spacing = 2 * radius / (nodes - 1);
    return {centre - Vec3::Constant(radius), Vec3::Constant(spacing), {nodes, nodes, nodes}};
  }
  BallSpline field(std::span<const double> coefficients) const {
    return {grid(), {coefficients.begin(), coefficients.end()}};
  }
  CoefficientShape shape() const { return {{nodes + 2, nodes + 2, nodes + 2}}; }
  /// With half the spacing.
  BallForm finer() const { return {centre, radius, 2 * nodes - 1}; }
};

struct RadialForm {
  Vec3 centre = Vec3::Zero();
  double radius = 1;
  int coefficients = 8;
  int finest = 8;  ///< so many has the next level: the first is one cubic, of four

  RadialSpline field(std::span<const double> values) const {
    return RadialSpline(RadialSplineProfile(radius, {values.begin(), values.end()}), centre);
  }
  CoefficientShape shape() const { return {{1, 1, coefficients}}; }
  RadialForm finer() const { return {centre, radius, finest, finest}; }
};

using FieldForm = std::variant<BallForm, RadialForm>;

inline CoefficientShape shape_of(const FieldForm& form) {
  return std::visit([](const auto& f) { return f.shape(); }, form);
}

/// The form of the next level, and the coefficients of the same field in it: knots are inserted.
struct FinerField {
  FieldForm form;
  std::vector<double> coefficients;
};
FinerField finer(const FieldForm& form, std::span<const double> coefficients);

}  // namespace flatspeckle::grin::design
