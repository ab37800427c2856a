#pragma once

#include "grin/media/geometry/vec3.h"
#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

/// Derivatives of the end point of a curve. first_angle and second_angle are its derivatives with
/// respect to the angles, in radians, by which the start direction turns towards two axes
/// perpendicular to it. `along` is the derivative with respect to the length of the curve, a unit
/// vector.
struct EndJacobian {
  Vec3 first_angle, second_angle, along;
};
struct CurveChange {
  double first_angle, second_angle, length;
};

/// Damped Gauss-Newton steps towards error = 0. The damping lambda = factor (|error| / width)^2
/// vanishes fast enough for quadratic convergence and does not require a Jacobian of full rank at
/// the solution [yamashita2001]. The factor falls after success and rises after failure.
class DampedStep {
 public:
  /// Returns the change that minimises |error + J change|^2 + lambda (width^2 angles^2 + length^2),
  /// where J is the Jacobian. `width` is the largest norm so far of the derivatives by the two
  /// angles.
  CurveChange operator()(const EndJacobian& jacobian, const Vec3& error);

  /// Records that the last step multiplied |error| by error_ratio, which is below 1.
  void succeeded(double error_ratio);
  void failed() { factor_ *= 8; }
  bool stuck() const { return factor_ > 1e12; }

 private:
  double width_ = 0;
  double factor_ = 0.5;
};

/// Returns a unit direction turned by the two angles along the axes of frame_across(direction). If
/// the turn exceeds 0.7 rad, both angles are scaled down.
Vec3 turned(const Vec3& direction, const CurveChange& change);

/// Start direction of a curve of the ray equation, and its length in sigma.
struct CurveStart {
  Vec3 direction;
  double sigma;
};
/// Returns direction and length of a curve after one damped step that reduces the error of its end.
/// The direction turns by at most 0.7 rad, and the length changes by at most half. n: index at the
/// start.
CurveStart stepped(const CurveStart& start, double n, const RayState& end,
                   const RayTangent& tangent, const Vec3& error, DampedStep& step);

}  // namespace flatspeckle::grin
