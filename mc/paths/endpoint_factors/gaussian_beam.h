#pragma once

#include <cmath>

#include "core/numbers/complex.h"
#include "flatland/request/light.h"

namespace flatspeckle::mc {

/// A paraxial Gaussian beam in 2D with the field u = sqrt(q0/q) exp(i k s + i k t^2 / (2 q)) with q
/// = s - i z_R, q0 = -i z_R, z_R = k waist^2 / 2. The coordinates s along the axis and t across it
/// are measured from the focus.
class GaussianBeam {
 public:
  GaussianBeam(const Light& light, double k)
      : axis_(direction(light.angle)),
        focus_(light.point),
        k_(k),
        waist_(light.waist),
        rayleigh_(k * light.waist * light.waist / 2) {}

  Vec2 axis() const { return axis_; }
  Vec2 focus() const { return focus_; }
  Vec2 across_axis() const { return {axis_.z, -axis_.x}; }
  double along(Vec2 x) const { return dot(x - focus_, axis_); }
  double across(Vec2 x) const { return dot(x - focus_, across_axis()); }

  /// Returns the distance from the axis at which |u| is 1/e of its value on the axis, at the
  /// coordinate s along the axis.
  double width(double s) const { return waist_ * std::hypot(1, s / rayleigh_); }

  /// Returns the unit vector along the gradient of the phase at x, the local wave vector.
  Vec2 ray(Vec2 x) const {
    const double s = along(x), tangent = across(x) * s / (s * s + rayleigh_ * rayleigh_);
    return 1 / std::hypot(1, tangent) * (axis_ + tangent * across_axis());
  }

  Complex field(Vec2 x) const {
    const double s = along(x), t = across(x);
    const Complex q(s, -rayleigh_), q0(0, -rayleigh_), i(0, 1);
    return std::sqrt(q0 / q) * std::exp(i * (k_ * s + 0.5 * k_ * t * t / q));
  }

 private:
  Vec2 axis_, focus_;
  double k_, waist_, rayleigh_;
};

}  // namespace flatspeckle::mc
