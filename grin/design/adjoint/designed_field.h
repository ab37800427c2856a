#pragma once

#include <array>
#include <concepts>

#include "grin/media/fields/ball_spline.h"
#include "grin/media/fields/graded_guide.h"
#include "grin/media/fields/radial_spline.h"

namespace flatspeckle::grin::design {

// A field whose coefficients are sought. look(field, x) is all that is to be known of a place, jet
// with the index among it; add_derivative(field, look, a, b, row_of) adds the derivatives of
// a excess + b . gradient there by the coefficients, which lie in rows: row_of(r) is where row r
// begins; shape_of(field) is how many there are.

/// Coefficients along x, y and z: rows of them along z.
struct CoefficientShape {
  std::array<int, 3> extent;

  int rows() const { return extent[0] * extent[1]; }
  int row_length() const { return extent[2]; }
  std::size_t size() const { return static_cast<std::size_t>(rows()) * row_length(); }
};

inline BallSpline::Look look(const BallSpline& field, const Vec3& x) {
  return field.look(x);
}
template <class Rows>
void add_derivative(const BallSpline& field, const BallSpline::Look& at, double a, const Vec3& b,
                    const Rows& row_of) {
  field.add_derivative(at, a, b, row_of);
}
inline CoefficientShape shape_of(const BallSpline& field) {
  return {field.spline().extent()};
}

inline SplineField::Look look(const SplineField& field, const Vec3& x) {
  return field.look(x);
}
template <class Rows>
void add_derivative(const SplineField& field, const SplineField::Look& at, double a, const Vec3& b,
                    const Rows& row_of) {
  SplineField::add_derivative(at, field.extent(), a, b, row_of);
}
inline CoefficientShape shape_of(const SplineField& field) {
  return {field.extent()};
}

struct RadialLook {
  Vec3 r;
  IndexHessian jet;
};
inline RadialLook look(const RadialSpline& field, const Vec3& x) {
  return {x - field.centre(), field.hessian(x)};
}
template <class Rows>
void add_derivative(const RadialSpline& field, const RadialLook& at, double a, const Vec3& b,
                    const Rows& row_of) {
  field.profile().add_derivative(at.r.squaredNorm(), a, 2 * b.dot(at.r), row_of(0));
}
inline CoefficientShape shape_of(const RadialSpline& field) {
  return {{1, 1, static_cast<int>(field.profile().coefficients().size())}};
}

/// Of a graded guide the coefficients of its correction are sought, or its exponent where it has
/// none.
inline RadialLook look(const GradedGuide& field, const Vec3& x) {
  const Vec3 r = x - field.centre();
  return {{r[0], r[1], 0}, field.hessian(x)};
}
template <class Rows>
void add_derivative(const GradedGuide& field, const RadialLook& at, double a, const Vec3& b,
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
  { look(field, x).jet } -> std::convertible_to<IndexHessian>;
  { shape_of(field) } -> std::same_as<CoefficientShape>;
};

}  // namespace flatspeckle::grin::design
