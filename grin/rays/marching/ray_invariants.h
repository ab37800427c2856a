#pragma once

#include <Eigen/Geometry>

#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

/// Quantities that are constant along a ray in fields of different symmetries (conventions, C27).
struct RayInvariants {
  double index_mismatch;  ///< |v| - n; 0 in any field
  Vec3 angular_momentum;  ///< (x - centre) cross v; constant in a spherically symmetric field
  double axial_momentum;  ///< component of v along the axis; constant in a guide
  double axial_rotation;  ///< angular momentum along the axis through the centre; constant in a
                          ///< round guide
  Vec3 transverse;  ///< part of v perpendicular to the axis, of length n sin(angle); constant in a
                    ///< field that varies only along the axis
};

template <IndexField F>
RayInvariants ray_invariants(const F& field, const RayState& ray, const Vec3& centre = Vec3::Zero(),
                             const Vec3& axis = Vec3::UnitZ()) {
  const Vec3 rotation = (ray.x - centre).cross(ray.v);
  const double along = axis.dot(ray.v);
  return {ray.v.norm() - index(field, ray.x), rotation, along, axis.dot(rotation),
          ray.v - along * axis};
}

}  // namespace flatspeckle::grin
