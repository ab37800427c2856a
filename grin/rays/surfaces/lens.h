#pragma once

#include <array>
#include <optional>

#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

/// One of the two faces of a lens: a part of a sphere, or a plane, about an axis along z. All
/// formulas use the curvature, so that a plane is the limit of a sphere without cancellation.
struct LensFace {
  Vec3 vertex;
  double outwards;   ///< z component of the outward direction: 1 or -1
  double curvature;  ///< 1 / radius of curvature, positive if the centre is at larger z; 0: plane
  double edge;       ///< z coordinate of the edge

  bool is_plane() const { return curvature == 0; }
  bool is_concave() const { return curvature * outwards > 0; }
  /// Returns the plane through the edge, which is the face itself if it is plane.
  Plane edge_plane() const { return {{0, 0, edge}, outwards * Vec3::UnitZ()}; }

  /// Returns the signed distance from the face, negative on the side of the lens. All points on the
  /// inner side of the edge plane of a convex face count as inside, so that the far half of its
  /// sphere has no effect.
  double distance(const Vec3& x) const {
    const double beyond = outwards * (x[2] - edge);
    if (is_plane()) return beyond;
    const Vec3 p = x - vertex;
    const double rise = 2 * p[2] - curvature * p.squaredNorm();
    const double outside = outwards * rise / (1 + (Vec3::UnitZ() - curvature * p).norm());
    return is_concave() ? std::max(outside, beyond) : std::min(outside, beyond);
  }
  Vec3 normal(const Vec3& x) const {
    return outwards * (Vec3::UnitZ() - curvature * (x - vertex)).normalized();
  }
};

/// A lens of two spherical or plane faces, cut to a cylinder about its axis, which is along z. Two
/// plane faces make a rod or a disk. |distance| never exceeds the true distance, as for every
/// surface.
class Lens {
 public:
  /// vertex: vertex of the front face, which is at the smaller z. front, back: radii of curvature
  /// with the sign of LensFace::curvature; 0 for a plane, otherwise at least `radius` in magnitude.
  /// Returns nullopt if the faces meet within the radius or the lens has no thickness on its axis.
  static std::optional<Lens> make(const Vec3& vertex, double radius, double front, double back,
                                  double thickness);

  double distance(const Vec3& x) const {
    return std::max({barrel_distance(x), faces_[0].distance(x), faces_[1].distance(x)});
  }
  Vec3 normal(const Vec3& x) const {
    const LensFace* const face = face_at(x);
    return face ? face->normal(x) : Vec3(across(x).normalized());
  }
  /// Returns d normal / d x, for displacements along the surface.
  Mat3 curvature(const Vec3& x) const;

  const std::array<LensFace, 2>& faces() const { return faces_; }
  double radius() const { return radius_; }
  /// Returns the vector from the axis to x, perpendicular to the axis.
  Vec3 across(const Vec3& x) const {
    return {x[0] - faces_[0].vertex[0], x[1] - faces_[0].vertex[1], 0};
  }
  /// Returns the squared distance of a point from the axis minus the squared radius.
  double barrel_power(const Vec3& x) const {
    return power_of_point({x[0], x[1], 0}, barrel_centre(), radius_);
  }
  bool is_convex() const { return !faces_[0].is_concave() && !faces_[1].is_concave(); }
  Box bounds() const;
  double volume() const;

 private:
  Lens(const std::array<LensFace, 2>& faces, double radius) : faces_(faces), radius_(radius) {}
  Vec3 barrel_centre() const { return {faces_[0].vertex[0], faces_[0].vertex[1], 0}; }
  double barrel_distance(const Vec3& x) const {
    return distance_from_sphere({x[0], x[1], 0}, barrel_centre(), radius_);
  }
  /// Returns the face to which x is nearest; nullptr if x is nearest to the cylinder.
  const LensFace* face_at(const Vec3& x) const;

  std::array<LensFace, 2> faces_;
  double radius_;
};

}  // namespace flatspeckle::grin
