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

/// A disk in space, and its points, uniformly by area.
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

/// The point of a sphere's or a box's surface next to x, where x is on it to 1e-6 of its size.
std::optional<BoundaryPoint> boundary_point(const Surface& boundary, const Vec3& x);

/// A part of a sphere's or a box's surface, sampled uniformly by its area.
class BoundaryPatch {
 public:
  /// All of it. Throws InputError naming `key` for another boundary.
  BoundaryPatch(const Surface& boundary, const char* key);

  /// What is within `radius` of `centre`, a point of the surface: a cap of a sphere, a disk on one
  /// face of a box; both have area pi radius^2. A sphere's cap may be all of it. Throws InputError
  /// for another boundary, a centre that is not on it, a radius that is not positive, and a disk
  /// that is not within one face.
  BoundaryPatch(const Surface& boundary, const Vec3& centre, double radius, const char* centre_key,
                const char* radius_key);

  double area() const { return area_; }
  BoundaryPoint sample(RandomStream& random) const;
  /// At this distance from the centre, of a patch that has one.
  BoundaryPoint polar(double r, double azimuth) const;
  /// Of points on the surface.
  bool contains(const Vec3& x) const;
  Vec3 inward(const Vec3& x) const;

 private:
  struct Cap {
    Sphere sphere;
    Vec3 centre, axis;  ///< axis: from the sphere's centre, unit
    double chord;       ///< from the centre to the rim
  };

  struct Faces {
    Box box;
    std::array<double, 3> pair_chance;  ///< of the two faces across each axis
  };
  static BoundaryPoint sample(const Cap& cap, RandomStream& random);
  static BoundaryPoint sample(const FlatDisk& disk, RandomStream& random);
  static BoundaryPoint sample(const Faces& faces, RandomStream& random);

  std::variant<Cap, FlatDisk, Faces> shape_;
  double area_;
};

}  // namespace flatspeckle::grin
