#pragma once

#include <array>
#include <optional>

#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

/// Rotationally symmetric face z = sag(rho^2) about an axis along z, with
/// sag = c rho^2 / (1 + sqrt(1 - (1 + k) c^2 rho^2)) + a4 rho^4 + a6 rho^6 + a8 rho^8 (ISO
/// 10110-12).
struct AsphericFace {
  double curvature = 0;  ///< c: 1 / radius of curvature, positive if the centre is at larger z
  double conic = 0;      ///< k: 0 for a sphere, -1 for a paraboloid
  std::array<double, 3> terms = {};  ///< a4, a6, a8

  /// Value of the sag and its derivatives with respect to u = rho^2.
  struct Sag {
    double value, first, second;
  };
  Sag sag(double u) const;
};

/// A lens of two aspheric faces, cut to a cylinder about its axis, which is along z. |distance|
/// never exceeds the true distance, as for every surface.
class AsphericLens {
 public:
  /// vertex: vertex of the front face, which is at the smaller z. Returns nullopt if a face does
  /// not extend to the radius, or if the faces meet within it.
  static std::optional<AsphericLens> make(const Vec3& vertex, double radius,
                                          const AsphericFace& front, const AsphericFace& back,
                                          double thickness);

  double distance(const Vec3& x) const;
  Vec3 normal(const Vec3& x) const;
  /// Returns d normal / d x, for displacements along the surface.
  Mat3 curvature(const Vec3& x) const;
  const Box& bounds() const { return bounds_; }
  double volume() const { return volume_; }

  /// Returns the distance from x along the unit vector d at which the line leaves (leaves = true)
  /// or enters the lens; infinity if it does not. A point on the surface within rounding counts as
  /// inside for leaving and as outside for entering.
  double crossing_distance(const Vec3& x, const Vec3& d, bool leaves) const;

 private:
  struct Face {
    AsphericFace shape;
    double vertex, outwards;  ///< z of the vertex; z component of the outward direction, 1 or -1
    double steepness;         ///< upper bound of the magnitude of the gradient of z - sag
  };
  AsphericLens(const Vec3& vertex, double radius, const std::array<Face, 2>& faces);

  double squared_rho(const Vec3& x) const;
  /// Returns the height of x above a face, along the axis, positive outside.
  double height(const Face& face, const Vec3& x) const;
  double barrel_distance(const Vec3& x) const;
  const Face* face_at(const Vec3& x) const;
  Vec3 gradient(const Face& face, const Vec3& x) const;

  Vec3 vertex_;
  double radius_;
  std::array<Face, 2> faces_;
  Box bounds_;
  double volume_ = 0;
};

}  // namespace flatspeckle::grin
