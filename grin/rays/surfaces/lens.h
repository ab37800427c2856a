#pragma once

#include <array>
#include <optional>

#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

/// One of the two faces of a lens: a part of a sphere, or a plane, about an axis along z. All about
/// it follows from its curvature, so that a plane is the limit of a sphere without cancellation.
struct LensFace {
  Vec3 vertex;
  double outwards;   ///< 1 or -1: along z
  double curvature;  ///< of its radius of curvature, positive where the centre is at larger z
  double edge;       ///< z where it ends

  bool is_plane() const { return curvature == 0; }
  bool is_concave() const { return curvature * outwards > 0; }
  /// The plane of a plane one, or through its edge.
  Plane edge_plane() const { return {{0, 0, edge}, outwards * Vec3::UnitZ()}; }

  /// From the cap that is the face: a convex one ends the lens before its edge only, whatever
  /// becomes of the far half of its sphere.
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

/// A lens of two spherical or plane faces, cut to a cylinder about its axis, which is along z; of
/// two plane ones a rod or a disk. As of every surface |distance| is nowhere more than the true
/// distance.
class Lens {
 public:
  /// vertex: of the front face, at the smaller z; front, back: radii of curvature as of LensFace,
  /// not below the radius; nothing of a lens whose faces meet within its radius or that has no
  /// thickness on its axis.
  static std::optional<Lens> make(const Vec3& vertex, double radius, double front, double back,
                                  double thickness);

  double distance(const Vec3& x) const {
    return std::max({barrel_distance(x), faces_[0].distance(x), faces_[1].distance(x)});
  }
  Vec3 normal(const Vec3& x) const {
    const LensFace* const face = face_at(x);
    return face ? face->normal(x) : Vec3(across(x).normalized());
  }
  /// d normal / d x.
  Mat3 curvature(const Vec3& x) const;

  const std::array<LensFace, 2>& faces() const { return faces_; }
  double radius() const { return radius_; }
  /// From the axis.
  Vec3 across(const Vec3& x) const {
    return {x[0] - faces_[0].vertex[0], x[1] - faces_[0].vertex[1], 0};
  }
  /// The square of a point's distance from the axis, less that of the cylinder.
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
  /// That x is nearest to; nothing: the cylinder.
  const LensFace* face_at(const Vec3& x) const;

  std::array<LensFace, 2> faces_;
  double radius_;
};

}  // namespace flatspeckle::grin
