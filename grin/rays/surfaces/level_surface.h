#pragma once

#include <array>
#include <memory>
#include <vector>

#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

class LevelGrid;

/// The zero level of f(x), a sum of cubic B-splines on a grid of cubes; f is negative inside.
/// Normals are computed from the gradient of f and are continuous, so that light is refracted at
/// exactly the surface that it crosses. |distance| never exceeds the true distance, as for every
/// surface.
class LevelSurface {
 public:
  /// coefficients: coefficients of the splines about the nodes origin + spacing (i, j, k), where k
  /// varies fastest. In the three outermost layers of nodes they must be positive. meant_volume:
  /// volume of the body that the surface approximates. Throws InputError if f is nowhere 0.
  LevelSurface(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
               std::vector<double> coefficients, double meant_volume);

  double distance(const Vec3& x) const;
  Vec3 normal(const Vec3& x) const;
  /// Returns d normal / d x, for displacements along the surface.
  Mat3 curvature(const Vec3& x) const;

  /// Returns a point of the surface close to x, which must be within some cells of the surface.
  Vec3 projected(const Vec3& x) const;

  /// Returns the distance from x along the unit vector d to the point where f changes its sign;
  /// infinity if f keeps its sign. sign: sign of f at x, 1 or -1. A point that is on the surface
  /// within rounding, or slightly beyond it, counts as on the side of `sign`. The crossing is then
  /// where f returns to its value at x.
  double crossing_distance(const Vec3& x, const Vec3& d, double sign) const;

  /// Returns a box around the surface, which is up to two cells larger than the surface.
  const Box& bounds() const;
  double spacing() const;
  double volume() const;
  double meant_volume() const { return meant_volume_; }
  /// Whether the surface seems convex: of some sampled points inside, the midpoint of each pair is
  /// inside too.
  bool is_probably_convex() const { return is_probably_convex_; }

 private:
  std::shared_ptr<const LevelGrid> grid_;
  double meant_volume_;
  bool is_probably_convex_;
};

}  // namespace flatspeckle::grin
