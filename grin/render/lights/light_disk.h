#pragma once

#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/lights/radial_profile.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// A disk inside the stage, or on its boundary, that shines to one side.
class LightDisk {
 public:
  /// Throws InputError naming `light`, "radius" and "direction" for a disk that reaches out of the
  /// stage, and for one that shines out of it.
  LightDisk(const char* light, const Vec3& centre, const Vec3& direction,
            const RadialProfile& profile, const Stage& stage);

  const Vec3& centre() const { return disk_.centre(); }
  const Vec3& axis() const { return disk_.normal(); }
  bool contains(const Vec3& x) const { return disk_.reaches(x); }
  /// Chance of a point of the disk, per area.
  double density(const Vec3& x) const { return profile_.density((x - centre()).squaredNorm()); }
  BoundaryPoint sample(RandomStream& random) const;
  /// Of the unit square; keeps chances.
  BoundaryPoint from_square(double u, double v) const;

 private:
  FlatDisk disk_;
  RadialProfile profile_;
};

}  // namespace flatspeckle::grin
