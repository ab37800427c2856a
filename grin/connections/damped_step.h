#pragma once

#include "grin/geometry/vec3.h"

namespace flatspeckle::grin {

/// How a curve's end moves: per radian of the start direction along two axes across it (lengths),
/// and per length of the curve (a unit vector).
struct EndJacobian {
  Vec3 first_angle, second_angle, along;
};
struct CurveChange {
  double first_angle, second_angle, length;
};

/// Damped Gauss-Newton steps towards error = 0. The damping lambda = factor (|error| / width)^2
/// vanishes fast enough for quadratic convergence and needs no derivative of full rank at the
/// solution (Yamashita and Fukushima 2001); the factor follows success and failure.
class DampedStep {
 public:
  /// Minimises |error + J change|^2 + lambda (width^2 (angles)^2 + length^2), where the width is
  /// the largest of the angle columns so far.
  CurveChange operator()(const EndJacobian& jacobian, const Vec3& error);

  /// The step multiplied |error| by this, below 1.
  void succeeded(double error_ratio);
  void failed() { factor_ *= 8; }
  bool stuck() const { return factor_ > 1e12; }

 private:
  double width_ = 0;
  double factor_ = 0.5;
};

}  // namespace flatspeckle::grin
