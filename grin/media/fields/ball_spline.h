#pragma once

#include <string>
#include <vector>

#include "grin/media/fields/spline_field.h"

namespace flatspeckle::grin {

/// Index field of a ball, whose index falls to that of its host at its rim: n = n_host + (1 -
/// r^2/R^2) s(x). r is the distance from the centre, R the radius, and s a cubic spline on the cube
/// around the ball. The index is smooth inside; its gradient jumps at the rim.
class BallSpline {
 public:
  /// grid: nodes of the spline s, which must form a cube. Throws InputError if they do not form a
  /// cube, or if there are not two more coefficients than nodes along each axis.
  BallSpline(const FieldGrid& grid, std::vector<double> coefficients, double host_excess = 0);

  const SplineField& spline() const { return spline_; }
  const Sphere& ball() const { return ball_; }
  double host_excess() const { return host_excess_; }  ///< n_host - 1

  double excess(const Vec3& x) const {
    return host_excess_ + height(x - ball_.centre) * spline_.excess(x);
  }
  IndexGradient gradient(const Vec3& x) const {
    const Vec3 r = x - ball_.centre;
    const IndexGradient s = spline_.gradient(x);
    return {host_excess_ + height(r) * s.excess,
            height(r) * s.gradient + s.excess * height_gradient(r)};
  }
  IndexHessian hessian(const Vec3& x) const {
    return product(x - ball_.centre, spline_.hessian(x));
  }

  /// Result of evaluate(x): vector r from the centre to x, and the spline s and the field at x,
  /// with derivatives.
  struct Evaluation {
    Vec3 r;
    SplineField::Evaluation spline;
    IndexHessian jet;
  };
  Evaluation evaluate(const Vec3& x) const {
    const Vec3 r = x - ball_.centre;
    const SplineField::Evaluation at = spline_.evaluate(x);
    return {r, at, product(r, at.jet)};
  }
  /// Adds the derivatives of a (n - 1) + b . grad n with respect to the spline coefficients to rows
  /// of sums, as SplineField::add_derivative() does.
  template <class Rows>
  void add_derivative(const Evaluation& at, double a, const Vec3& b, const Rows& row_of) const {
    SplineField::add_derivative(at.spline, spline_.extent(),
                                a * height(at.r) + b.dot(height_gradient(at.r)), height(at.r) * b,
                                row_of);
  }

 private:
  double height(const Vec3& r) const { return 1 - r.squaredNorm() * inverse_area_; }
  Vec3 height_gradient(const Vec3& r) const { return -2 * inverse_area_ * r; }
  IndexHessian product(const Vec3& r, const IndexHessian& s) const {
    const Vec3 q = height_gradient(r);
    Mat3 hessian = height(r) * s.hessian + q * s.gradient.transpose() + s.gradient * q.transpose();
    hessian.diagonal().array() -= 2 * inverse_area_ * s.excess;
    return {host_excess_ + height(r) * s.excess, height(r) * s.gradient + s.excess * q, hessian};
  }

  SplineField spline_;
  Sphere ball_;
  double inverse_area_, host_excess_;
};

FieldFacts facts(const BallSpline& field);

struct BallValues {
  using Field = BallSpline;
  static constexpr const char* word = "ball";
  static constexpr bool is_medium = true;
  std::string ball{};
};

void add_keys(Keys& keys, BallValues& values);
/// Reads the field from the file given by its key. Throws an InputError that names the file.
BallSpline make_field(const Keys& keys, const BallValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin
