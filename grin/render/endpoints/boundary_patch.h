#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <variant>

#include "core/numbers/random.h"
#include "grin/media/geometry/frame.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

struct BoundaryPoint {
  Vec3 x, inward;
};

/// A disk in space; its points are sampled uniformly by area.
class FlatDisk {
 public:
  FlatDisk(const Vec3& centre, const Vec3& normal, double radius)
      : centre_(centre), normal_(normal), radius_(radius), across_(frame_across(normal)) {}

  const Vec3& centre() const { return centre_; }
  const Vec3& normal() const { return normal_; }
  Vec3 polar(double r, double azimuth) const {
    return at(r * std::cos(azimuth), r * std::sin(azimuth));
  }
  Vec3 sample(RandomStream& random) const {
    double a, b;
    do {
      a = 2 * random.uniform() - 1;
      b = 2 * random.uniform() - 1;
    } while (a * a + b * b > 1);
    return at(a * radius_, b * radius_);
  }
  bool reaches(const Vec3& x) const { return (x - centre_).norm() <= radius_; }

 private:
  Vec3 at(double a, double b) const { return centre_ + a * across_.col(0) + b * across_.col(1); }

  Vec3 centre_, normal_;
  double radius_;
  Frame across_;
};

/// Returns the point nearest to x on a sphere or box, if x is within 1e-6 of its size from the
/// surface; else nullopt.
std::optional<BoundaryPoint> boundary_point(const Surface& boundary, const Vec3& x);

/// A part of the surface of a sphere or box, sampled uniformly by area.
class BoundaryPatch {
 public:
  /// Makes a patch that is the whole boundary. Throws InputError, naming `key`, unless the boundary
  /// is a sphere or a box.
  BoundaryPatch(const Surface& boundary, const char* key);

  /// Makes the patch within `radius` of `centre`, a point of the surface: a cap of a sphere or a
  /// disk on one face of a box; both have area pi radius^2. A cap may be the whole sphere. Throws
  /// InputError if the boundary is neither a sphere nor a box, the centre is not on it, the radius
  /// is not positive, or the disk is not within one face.
  BoundaryPatch(const Surface& boundary, const Vec3& centre, double radius, const char* centre_key,
                const char* radius_key);

  double area() const { return area_; }
  BoundaryPoint sample(RandomStream& random) const;
  /// Returns the point of the patch at distance r and this azimuth from its centre. Requires a
  /// patch that has a centre.
  BoundaryPoint polar(double r, double azimuth) const;
  /// Whether a point on the surface is in the patch.
  bool contains(const Vec3& x) const;
  Vec3 inward(const Vec3& x) const;

 private:
  struct Cap {
    Sphere sphere;
    Vec3 centre, axis;  ///< axis: unit, from the centre of the sphere to that of the cap
    double chord;       ///< distance from the centre of the cap to its rim
  };

  struct Faces {
    Box box;
    /// Probability of sampling each pair of opposite faces, by the axis normal to them.
    std::array<double, 3> pair_probability;
  };
  static BoundaryPoint sample(const Cap& cap, RandomStream& random);
  static BoundaryPoint sample(const FlatDisk& disk, RandomStream& random);
  static BoundaryPoint sample(const Faces& faces, RandomStream& random);

  std::variant<Cap, FlatDisk, Faces> shape_;
  double area_;
};

}  // namespace flatspeckle::grin
