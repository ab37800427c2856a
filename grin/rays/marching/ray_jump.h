#pragma once

#include <variant>

#include "grin/rays/marching/ray_step.h"
#include "grin/rays/surfaces/interface.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// Refraction or reflection of a ray at a surface where the index jumps. Neighbouring rays meet the
/// surface at other points, so that the tangent map dx/dv0 jumps too (conventions, C25).
class RayJump {
 public:
  /// from, to: index and gradient on the side from which the ray comes and on the other side.
  RayJump(const Surface& surface, const RayState& ray, const IndexGradient& from,
          const IndexGradient& to)
      : normal_(normal(surface, ray.x)),
        face_(ray.v, normal_, from.excess, to.excess),
        turn_(std::visit([&](const auto& s) { return s.curvature(ray.x); }, surface)),
        force_(ray_force(from)),
        change_of_force_(ray_force(to) - force_),
        has_concave_parts_(has_concavity(surface)) {
    if (ray.v.dot(normal_) >= 0) return;
    normal_ = -normal_;
    turn_ = -turn_;
  }

  bool is_total() const { return face_.is_total(); }
  double reflectance() const { return face_.reflectance(); }
  /// Returns the Fresnel probability that the ray is reflected or, if `reflected` is false,
  /// refracted.
  double probability(bool reflected) const { return reflected ? reflectance() : 1 - reflectance(); }
  /// Whether the surface has concave parts. Between two points there may then be many paths through
  /// the surface, each of which is rarely found.
  bool has_concave_parts() const { return has_concave_parts_; }

  /// Refracts the ray. Must not be called if the reflection is total.
  void refract(RayState& ray, RayTangent* tangent = nullptr) const {
    const Vec3 refracted = *face_.refracted();
    if (tangent) {
      const Turned turned = meet(ray, *tangent);
      const double q1 = normal_.dot(ray.v), q2 = normal_.dot(refracted);
      const RowVec3 q2_change = (q1 * turned.q1 + change_of_force_.transpose() * tangent->dx) / q2;
      tangent->dv += normal_ * (q2_change - turned.q1) + (q2 - q1) * turned.normal;
    }
    ray.v = refracted;
  }
  void reflect(RayState& ray, RayTangent* tangent = nullptr) const {
    if (tangent) {
      const Turned turned = meet(ray, *tangent);
      tangent->dv -= 2 * (normal_ * turned.q1 + normal_.dot(ray.v) * turned.normal);
    }
    ray.v = face_.reflected();
  }
  void pass(bool reflects, RayState& ray, RayTangent* tangent = nullptr) const {
    reflects ? reflect(ray, tangent) : refract(ray, tangent);
  }

 private:
  static bool has_concavity(const Surface& surface) {
    const auto* level = std::get_if<LevelSurface>(&surface);
    return level && !level->is_probably_convex();
  }

  using RowVec3 = Eigen::RowVector3d;
  /// Derivatives of the normal and of q1 = v . normal with respect to the start vector v0 of the
  /// ray, at the points where neighbouring rays meet the surface.
  struct Turned {
    Mat3 normal;
    RowVec3 q1;
  };
  Turned meet(const RayState& ray, RayTangent& tangent) const {
    const RowVec3 sooner = -(normal_.transpose() * tangent.dx) / normal_.dot(ray.v);
    tangent.dx += ray.v * sooner;
    tangent.dv += force_ * sooner;
    const Mat3 turned = turn_ * tangent.dx;
    return {turned, normal_.transpose() * tangent.dv + ray.v.transpose() * turned};
  }

  Vec3 normal_;  ///< unit normal on the side towards which the ray goes
  Interface face_;
  Mat3 turn_;
  Vec3 force_, change_of_force_;
  bool has_concave_parts_;
};

}  // namespace flatspeckle::grin
