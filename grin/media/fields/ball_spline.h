#pragma once

#include <string>
#include <vector>

#include "grin/media/fields/spline_field.h"

namespace flatspeckle::grin {

/// A ball whose index comes down to 1 at its rim: n - 1 = (1 - r^2/R^2) s(x), s a cubic spline over
/// the cube about it. Inside of the rim it is smooth; there its gradient jumps.
class BallSpline {
 public:
  /// grid: the nodes of s, of a cube. Throws InputError for anything else, or another number of
  /// coefficients than two more along each axis than nodes.
  BallSpline(const FieldGrid& grid, std::vector<double> coefficients);

  const SplineField& spline() const { return spline_; }
  const Sphere& ball() const { return ball_; }

  double excess(const Vec3& x) const { return height(x - ball_.centre) * spline_.excess(x); }
  IndexGradient gradient(const Vec3& x) const {
    const Vec3 r = x - ball_.centre;
    const IndexGradient s = spline_.gradient(x);
    return {height(r) * s.excess, height(r) * s.gradient + s.excess * slope(r)};
  }
  IndexHessian hessian(const Vec3& x) const {
    return product(x - ball_.centre, spline_.hessian(x));
  }

  /// A place, the field there, and the spline.
  struct Look {
    Vec3 r;
    SplineField::Look spline;
    IndexHessian jet;
  };
  Look look(const Vec3& x) const {
    const Vec3 r = x - ball_.centre;
    const SplineField::Look at = spline_.look(x);
    return {r, at, product(r, at.jet)};
  }
  /// As the spline's own.
  template <class Rows>
  void add_derivative(const Look& at, double a, const Vec3& b, const Rows& row_of) const {
    SplineField::add_derivative(at.spline, spline_.extent(), a * height(at.r) + b.dot(slope(at.r)),
                                height(at.r) * b, row_of);
  }

 private:
  double height(const Vec3& r) const { return 1 - r.squaredNorm() * inverse_area_; }
  Vec3 slope(const Vec3& r) const { return -2 * inverse_area_ * r; }
  IndexHessian product(const Vec3& r, const IndexHessian& s) const {
    const Vec3 q = slope(r);
    Mat3 hessian = height(r) * s.hessian + q * s.gradient.transpose() + s.gradient * q.transpose();
    hessian.diagonal().array() -= 2 * inverse_area_ * s.excess;
    return {height(r) * s.excess, height(r) * s.gradient + s.excess * q, hessian};
  }

  SplineField spline_;
  Sphere ball_;
  double inverse_area_;
};

FieldFacts facts(const BallSpline& field);

struct BallValues {
  using Field = BallSpline;
  static constexpr const char* word = "ball";
  static constexpr bool is_medium = true;
  std::string ball{};
};

void add_keys(Keys& keys, BallValues& values);
/// Throws InputError naming the file.
BallSpline make_field(const Keys& keys, const BallValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin
