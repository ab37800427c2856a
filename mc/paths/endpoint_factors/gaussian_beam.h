#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/numbers/complex.h"
#include "flatland/request/light.h"

namespace flatspeckle::mc {

/// A paraxial Gaussian beam with the field u = (q0/q)^(d/2) exp(i k s + i k t^2 / (2 q)) in d = 1
/// transverse dimension in the plane and d = 2 in space (C58), with q = s - i z_R, q0 = -i z_R, z_R
/// = k waist^2 / 2. s is the coordinate along the axis, t the distance from the axis; both are
/// measured from the focus.
class GaussianBeam {
 public:
  GaussianBeam(const Light& light, double k, int dimension)
      : axis_(light.direction()),
        focus_(light.point),
        k_(k),
        waist_(light.waist),
        rayleigh_(k * light.waist * light.waist / 2),
        in_space_(dimension == 3) {
    if (axis_.y == 0) {
      across_ = {Vec{axis_.z, -axis_.x}, Vec{0, 0, 1}};
      return;
    }
    const Vec across = cross(std::abs(axis_.y) < 0.9 ? Vec{0, 0, 1} : Vec{0, 1}, axis_);
    across_[0] = 1 / length(across) * across;
    across_[1] = cross(axis_, across_[0]);
  }

  Vec axis() const { return axis_; }
  Vec focus() const { return focus_; }
  /// Number of transverse dimensions.
  std::size_t transverse() const { return in_space_ ? 2 : 1; }
  /// Unit vectors perpendicular to the axis and, in space, to each other.
  Vec across_axis(std::size_t number) const { return across_[number]; }
  double along(Vec x) const { return dot(x - focus_, axis_); }
  double across(Vec x, std::size_t number) const { return dot(x - focus_, across_[number]); }

  /// Returns the distance from the axis at which |u| is 1/e of its value on the axis, at the
  /// coordinate s along the axis.
  double width(double s) const { return waist_ * std::hypot(1, s / rayleigh_); }

  /// Returns the unit vector along the gradient of the phase at x, the local wave vector.
  Vec ray(Vec x) const {
    const double s = along(x), per_distance = s / (s * s + rayleigh_ * rayleigh_),
                 tangent = across(x, 0) * per_distance;
    if (!in_space_) return 1 / std::hypot(1, tangent) * (axis_ + tangent * across_[0]);
    const Vec w = axis_ + tangent * across_[0] + across(x, 1) * per_distance * across_[1];
    return 1 / length(w) * w;
  }

  Complex field(Vec x) const {
    const double s = along(x), t = across(x, 0), other = in_space_ ? across(x, 1) : 0;
    const Complex q(s, -rayleigh_), q0(0, -rayleigh_), i(0, 1);
    const Complex decrease = in_space_ ? q0 / q : std::sqrt(q0 / q);
    return decrease * std::exp(i * (k_ * s + 0.5 * k_ * (t * t + other * other) / q));
  }

 private:
  Vec axis_, focus_;
  double k_, waist_, rayleigh_;
  bool in_space_;
  std::array<Vec, 2> across_{};
};

}  // namespace flatspeckle::mc
