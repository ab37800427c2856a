#pragma once

#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

/// Interpolates a step of a ray between its ends by Hermite cubics, which have the same order as
/// the integrators. The state within the step, at theta from 0 to 1, then needs no evaluation of
/// the field.
class StepCurve {
 public:
  StepCurve(const RayState& start, const RayState& end, double h)
      : start_(start), end_(end), h_(h), n_start_(start.v.norm()), n_end_(end.v.norm()) {}

  Vec3 x(double theta) const {
    const auto [a, da, b, db] = weights(theta);
    return a * start_.x + da * start_.v + b * end_.x + db * end_.v;
  }
  double end_arc_length() const { return end_.arc_length; }
  double arc_length(double theta) const {
    const auto [a, da, b, db] = weights(theta);
    return a * start_.arc_length + da * n_start_ + b * end_.arc_length + db * n_end_;
  }
  /// Returns theta where the arc length is `s`, which must be within the step.
  double theta_at(double s) const {
    double theta = (s - start_.arc_length) / (end_.arc_length - start_.arc_length);
    for (int i = 0; i < 3; ++i) {
      const double index = n_start_ + theta * (n_end_ - n_start_);
      theta += (s - arc_length(theta)) / (index * h_);
    }
    return theta < 0 ? 0 : theta > 1 ? 1 : theta;
  }

 private:
  struct Weights {
    double a, da, b, db;
  };
  Weights weights(double t) const {
    const double r = 1 - t;
    return {(1 + 2 * t) * r * r, h_ * t * r * r, t * t * (3 - 2 * t), -h_ * t * t * r};
  }

  const RayState &start_, &end_;
  double h_, n_start_, n_end_;
};

}  // namespace flatspeckle::grin
