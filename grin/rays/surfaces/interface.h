#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Reflection and refraction of the ray vector v at an interface from index n1 = 1 + excess_from to
/// n2 = 1 + excess_to, and the fractions of power. `normal` is a unit vector normal to the
/// interface, of either sign. An index step of 1e-6 keeps its digits.
class Interface {
 public:
  Interface(const Vec3& v, const Vec3& normal, double excess_from, double excess_to)
      : v_(v),
        normal_(v.dot(normal) < 0 ? Vec3(-normal) : normal),
        n1_(1 + excess_from),
        n2_(1 + excess_to),
        jump_((excess_to - excess_from) * (2 + excess_to + excess_from)),
        q1_(v.dot(normal_)),
        q2_squared_(q1_ * q1_ + jump_) {}

  /// Also true if the index beyond is 0, which stands for an opaque body.
  bool is_total() const { return q2_squared_ <= 0 || n2_ == 0; }

  Vec3 reflected() const { return v_ - 2 * q1_ * normal_; }

  /// Returns the refracted vector, of length n2, by Snell's law: the tangential component is kept.
  /// Returns nullopt for total reflection.
  std::optional<Vec3> refracted() const {
    if (is_total()) return std::nullopt;
    return v_ + change() * normal_;
  }

  /// Returns the reflected fraction of power (Fresnel) for light polarised perpendicular (s) or
  /// parallel (p) to the plane of incidence. Formulas use q1 and q2, the values of n cos(angle) on
  /// the two sides.
  double reflectance_s() const {
    if (is_total()) return 1;
    const double r = change() / (q1_ + q2());
    return r * r;
  }
  double reflectance_p() const {
    if (is_total()) return 1;
    const double n1 = n1_ * n1_, n2 = n2_ * n2_;
    const double r = (jump_ * q1_ - n1 * change()) / (n2 * q1_ + n1 * q2());
    return r * r;
  }
  double reflectance() const { return (reflectance_s() + reflectance_p()) / 2; }

 private:
  double q2() const { return std::sqrt(std::max(0.0, q2_squared_)); }
  /// Returns q2 - q1, the change of the normal component of v.
  double change() const { return jump_ / (q1_ + q2()); }

  Vec3 v_, normal_;
  double n1_, n2_, jump_;  ///< jump_: n2^2 - n1^2
  double q1_, q2_squared_;
};

}  // namespace flatspeckle::grin
