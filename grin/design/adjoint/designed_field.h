#pragma once

#include <array>
#include <concepts>

#include "grin/media/fields/ball_spline.h"
#include "grin/media/fields/graded_guide.h"
#include "grin/media/fields/radial_spline.h"

namespace flatspeckle::grin::design {

// Functions of a field whose coefficients are optimised. evaluate(field, x) returns the field at x
// with its derivatives; the member `jet` of the result contains n - 1, the gradient and the
// Hessian. add_derivative(field, at, a, b, row_of) adds the derivatives of the number a (n - 1) + b
// . (grad n) with respect to the coefficients to sums, which are stored in rows; row_of(r) points
// to the start of row r. shape_of(field) returns the number of coefficients along each axis.

/// Numbers of coefficients of a field along x, y and z; rows of coefficients run along z.
struct CoefficientShape {
  std::array<int, 3> extent;

  int rows() const { return extent[0] * extent[1]; }
  int row_length() const { return extent[2]; }
  std::size_t size() const { return static_cast<std::size_t>(rows()) * row_length(); }
};

inline BallSpline::Evaluation evaluate(const BallSpline& field, const Vec3& x) {
  return field.evaluate(x);
}
template <class Rows>
void add_derivative(const BallSpline& field, const BallSpline::Evaluation& at, double a,
                    const Vec3& b, const Rows& row_of) {
  field.add_derivative(at, a, b, row_of);
}
inline CoefficientShape shape_of(const BallSpline& field) {
  return {field.spline().extent()};
}

inline SplineField::Evaluation evaluate(const SplineField& field, const Vec3& x) {
  return field.evaluate(x);
}
template <class Rows>
void add_derivative(const SplineField& field, const SplineField::Evaluation& at, double a,
                    const Vec3& b, const Rows& row_of) {
  SplineField::add_derivative(at, field.extent(), a, b, row_of);
}
inline CoefficientShape shape_of(const SplineField& field) {
  return {field.extent()};
}

struct RadialValue {
  Vec3 r;
  IndexHessian jet;
};
inline RadialValue evaluate(const RadialSpline& field, const Vec3& x) {
  return {x - field.centre(), field.hessian(x)};
}
template <class Rows>
void add_derivative(const RadialSpline& field, const RadialValue& at, double a, const Vec3& b,
                    const Rows& row_of) {
  field.profile().add_derivative(at.r.squaredNorm(), a, 2 * b.dot(at.r), row_of(0));
}
inline CoefficientShape shape_of(const RadialSpline& field) {
  return {{1, 1, static_cast<int>(field.profile().coefficients().size())}};
}

/// Evaluates a graded guide. The coefficients of the guide are those of the profile correction, or
/// the exponent if there is no correction.
inline RadialValue evaluate(const GradedGuide& field, const Vec3& x) {
  const Vec3 r = x - field.centre();
  return {{r[0], r[1], 0}, field.hessian(x)};
}
template <class Rows>
void add_derivative(const GradedGuide& field, const RadialValue& at, double a, const Vec3& b,
                    const Rows& row_of) {
  const double u = at.r.squaredNorm(), by_u = 2 * b.dot(at.r);
  if (field.profile().is_corrected())
    field.profile().add_by_correction(u, a, by_u, row_of(0));
  else
    field.profile().add_by_exponent(u, a, by_u, row_of(0));
}
inline CoefficientShape shape_of(const GradedGuide& field) {
  const GradedProfile& profile = field.profile();
  return {{1, 1, profile.is_corrected() ? static_cast<int>(profile.correction().size()) : 1}};
}

template <class F>
concept DesignedField = IndexField<F> && requires(const F& field, const Vec3& x) {
  { evaluate(field, x).jet } -> std::convertible_to<IndexHessian>;
  { shape_of(field) } -> std::same_as<CoefficientShape>;
};

}  // namespace flatspeckle::grin::design
