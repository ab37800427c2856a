#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "grin/design/adjoint/designed_field.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin::design {

// Parametrisations of a designed field. A form, such as BallForm, contains all properties of the
// field except its coefficients.

struct BallForm {
  Vec3 centre = Vec3::Zero();
  double radius = 1;
  int nodes = 5;  ///< number of nodes along each axis of the cube that contains the ball

  FieldGrid grid() const {
    const double spacing = 2 * radius / (nodes - 1);
    return {centre - Vec3::Constant(radius), Vec3::Constant(spacing), {nodes, nodes, nodes}};
  }
  BallSpline field(std::span<const double> coefficients) const {
    return {grid(), {coefficients.begin(), coefficients.end()}};
  }
  CoefficientShape shape() const { return {{nodes + 2, nodes + 2, nodes + 2}}; }
  /// Returns the form with half the node spacing.
  BallForm finer() const { return {centre, radius, 2 * nodes - 1}; }
};

struct RadialForm {
  Vec3 centre = Vec3::Zero();
  double radius = 1;
  int coefficients = 8;
  /// Number of coefficients in the next refinement level. The first level is a single cubic, which
  /// has four coefficients.
  int finest = 8;

  RadialSpline field(std::span<const double> values) const {
    return RadialSpline(RadialSplineProfile(radius, {values.begin(), values.end()}), centre);
  }
  CoefficientShape shape() const { return {{1, 1, coefficients}}; }
  RadialForm finer() const { return {centre, radius, finest, finest}; }
};

/// A cube in which n - 1 is a cubic spline. The outermost coefficients are fixed at 0, so that the
/// spline and its first two derivatives vanish at the faces.
struct BoxForm {
  static constexpr int held = 3;  ///< number of fixed coefficients at each end of an axis

  Vec3 centre = Vec3::Zero();
  double radius = 1;  ///< half a side
  int nodes = 9;      ///< number of nodes along each axis

  FieldGrid grid() const { return BallForm{centre, radius, nodes}.grid(); }
  SplineField field(std::span<const double> coefficients) const {
    return SplineField::of_coefficients(grid(), {coefficients.begin(), coefficients.end()});
  }
  CoefficientShape shape() const { return {{nodes + 2, nodes + 2, nodes + 2}}; }
  BoxForm finer() const { return {centre, radius, 2 * nodes - 1}; }
};

/// A graded guide along z. The optimised coefficients are those of the profile correction. If
/// `coefficients` is 0, there is no correction and the exponent is optimised.
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

/// Lower and upper bound of each coefficient.
struct Bounds {
  std::vector<double> least, most;
  CoefficientShape shape = {{1, 1, 1}};
  /// Largest difference between neighbouring coefficients; nullopt: unlimited.
  std::optional<double> most_difference = {};

  /// Changes the values so that they keep the bounds.
  void hold(std::span<double> values) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = std::clamp(values[i], least[i], most[i]);
    if (most_difference) hold_differences(values);
  }

 private:
  void hold_differences(std::span<double> values) const;
};
/// Returns the bounds of the coefficients that keep the index between least_index and most_index.
/// For a guide, these limits are not used: its exponent and correction have fixed bounds.
Bounds bounds_of(const FieldForm& form, double least_index, double most_index);

/// Whether the basis spline of a coefficient is centred inside the field. This is false in the
/// corners of the cube that contains a ball.
bool is_within(const FieldForm& form, std::size_t coefficient);

/// Returns the surface at which light enters and leaves the field; nullopt for a guide, which is
/// infinitely long.
std::optional<Surface> hull_of(const FieldForm& form);

/// Form of the field in the next refinement level, and the coefficients that represent the same
/// field in that form (knot insertion).
struct FinerField {
  FieldForm form;
  std::vector<double> coefficients;
};
FinerField finer(const FieldForm& form, std::span<const double> coefficients);

}  // namespace flatspeckle::grin::design
