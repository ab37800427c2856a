#pragma once

#include "grin/media/geometry/vec3.h"
#include "grin/rays/marching/ray.h"

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

/// A unit direction turned by the angles along frame_across(direction), of which as much as makes
/// a turn of 0.7 rad at most.
Vec3 turned(const Vec3& direction, const CurveChange& change);

/// How a curve of the ray equation starts, and its length in sigma.
struct CurveStart {
  Vec3 direction;
  double sigma;
};
/// After one step towards error = 0, that of its end: turned as above, longer or shorter by half at
/// most. n: the index where it starts.
CurveStart stepped(const CurveStart& start, double n, const RayState& end,
                   const RayTangent& tangent, const Vec3& error, DampedStep& step);

}  // namespace flatspeckle::grin
