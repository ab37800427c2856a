#pragma once

#include <array>
#include <memory>
#include <vector>

#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

class LevelGrid;

/// Where f(x), a sum of cubic B-splines on a grid of cubes, is 0; inside it is negative. Normals
/// are those of f itself and turn without jumps, so that light is refracted at the very surface
/// that it crosses. As of every surface |distance| is nowhere more than the true distance.
class LevelSurface {
 public:
  /// Coefficients of the splines about the nodes origin + spacing (i, j, k), k fastest; those of
  /// the three outermost nodes must be positive. meant_volume: of what the surface stands for.
  /// Throws InputError where f is nowhere 0.
  LevelSurface(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
               std::vector<double> coefficients, double meant_volume);

  double distance(const Vec3& x) const;
  Vec3 normal(const Vec3& x) const;
  /// d normal / d x, for displacements along the surface.
  Mat3 curvature(const Vec3& x) const;

  /// From x along the unit vector d to where f changes its sign, which is 1 or -1 at x; infinity
  /// where it does not. What is on the surface to rounding, or beyond it, is on the side that the
  /// sign says, and goes on to the same value of f.
  double way(const Vec3& x, const Vec3& d, double sign) const;

  /// Around the surface, up to two cells wider than that.
  const Box& bounds() const;
  double spacing() const;
  double volume() const;
  double meant_volume() const { return meant_volume_; }
  /// Of some places inside, no two have one outside halfway between them.
  bool looks_convex() const { return looks_convex_; }

 private:
  std::shared_ptr<const LevelGrid> grid_;
  double meant_volume_;
  bool looks_convex_;
};

}  // namespace flatspeckle::grin
