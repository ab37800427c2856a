#pragma once

#include <variant>

#include "grin/rays/surfaces/aspheric_lens.h"
#include "grin/rays/surfaces/lens.h"

namespace flatspeckle::grin {

/// A box or lens that is rotated and displaced: x = origin + turn * (x in the frame of the shape).
class TurnedShape {
 public:
  using Shape = std::variant<Box, Lens, AsphericLens>;

  /// turn: rotation matrix.
  TurnedShape(const Shape& shape, const Vec3& origin, const Mat3& turn)
      : shape_(shape), origin_(origin), turn_(turn) {}
  /// Rotates a shape about its middle, by the length of `rotation` in rad, about its direction.
  TurnedShape(const Shape& shape, const Vec3& rotation);
  /// Makes the cylinder about the line from one point to another, which must differ.
  static TurnedShape cylinder(const Vec3& from, const Vec3& to, double radius);

  double distance(const Vec3& x) const;
  Vec3 normal(const Vec3& x) const;
  /// Returns d normal / d x, for displacements along the surface.
  Mat3 curvature(const Vec3& x) const;
  /// Returns the bounding box of the box, or of the cylinder to which a lens is cut.
  Box bounds() const;
  double volume() const;
  bool is_convex() const;

  /// Distance from x along the unit vector d at which the line leaves or enters the shape; as the
  /// functions of these names in straight_crossing.h.
  double exit_distance(const Vec3& x, const Vec3& d) const;
  double entry_distance(const Vec3& x, const Vec3& d) const;

 private:
  Vec3 own(const Vec3& x) const { return turn_.transpose() * (x - origin_); }

  Shape shape_;
  Vec3 origin_;
  Mat3 turn_;
};

}  // namespace flatspeckle::grin
