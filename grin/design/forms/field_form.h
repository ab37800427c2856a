#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "grin/design/adjoint/designed_field.h"
#include "grin/rays/surfaces/signed_distance.h"

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

/// A cube in which n - 1 is a cubic spline that comes down to 0 at the faces with its first two
/// derivatives: its outermost coefficients are held at 0.
struct BoxForm {
  static constexpr int held = 3;  ///< at each end of an axis

  Vec3 centre = Vec3::Zero();
  double radius = 1;  ///< half a side
  int nodes = 9;      ///< along each axis

  FieldGrid grid() const { return BallForm{centre, radius, nodes}.grid(); }
  SplineField field(std::span<const double> coefficients) const {
    return SplineField::of_coefficients(grid(), {coefficients.begin(), coefficients.end()});
  }
  CoefficientShape shape() const { return {{nodes + 2, nodes + 2, nodes + 2}}; }
  BoxForm finer() const { return {centre, radius, 2 * nodes - 1}; }
};

/// A graded guide along z: its correction, or its exponent where that has no coefficients.
struct GuideForm {
  GradedProfile::Core core;
  int coefficients = 8;

  GradedGuide field(std::span<const double> values) const {
    if (coefficients == 0)
      return GradedGuide(
          GradedProfile({core.axis_excess, core.delta, core.radius, values.front()}));
    return GradedGuide(GradedProfile(core, {values.begin(), values.end()}));
  }
  CoefficientShape shape() const { return {{1, 1, std::max(coefficients, 1)}}; }
  GuideForm finer() const { return *this; }
};

using FieldForm = std::variant<BallForm, RadialForm, BoxForm, GuideForm>;

inline CoefficientShape shape_of(const FieldForm& form) {
  return std::visit([](const auto& f) { return f.shape(); }, form);
}

/// The least and the most of each coefficient.
struct Bounds {
  std::vector<double> least, most;

  void hold(std::span<double> values) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = std::clamp(values[i], least[i], most[i]);
  }
};
/// So that the index stays between two, but for a guide, whose exponent and correction have their
/// own.
Bounds bounds_of(const FieldForm& form, double least_index, double most_index);

/// Whether the middle of a coefficient's spline is inside of the field: of others a ball has many.
bool is_within(const FieldForm& form, std::size_t coefficient);

/// Where light comes to the field and leaves it. Nothing of a guide, which is endless.
std::optional<Surface> hull_of(const FieldForm& form);

/// The form of the next level, and the coefficients of the same field in it: knots are inserted.
struct FinerField {
  FieldForm form;
  std::vector<double> coefficients;
};
FinerField finer(const FieldForm& form, std::span<const double> coefficients);

}  // namespace flatspeckle::grin::design
