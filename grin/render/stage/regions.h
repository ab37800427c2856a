#pragma once

#include <optional>
#include <vector>

#include "grin/rays/surfaces/straight_crossing.h"
#include "grin/rays/surfaces/surface_region.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

struct PathPoint {
  Vec3 x = Vec3::Zero();
  Part part = around;
};

/// Where a segment within one part ends: at a collision (-1), at the boundary (0), or at the
/// surface of a body, which has the number of the body.
using SegmentEnd = int;
inline constexpr SegmentEnd at_collision = -1, at_boundary = 0;

/// Locates positions in the parts of a stage, and the exits of straight lines from them.
class Regions {
 public:
  /// farthest: largest coordinate at which lines start; nullopt: the largest coordinate of the
  /// stage's boundary.
  explicit Regions(const Stage& stage, std::optional<double> farthest = {});

  Part parts() const { return static_cast<Part>(surfaces_.size()); }
  const Surface& surface(SegmentEnd number) const { return surfaces_[number]; }
  /// Returns the region of a part: inside its surface and outside of the bodies that come later,
  /// which replace it where they overlap it.
  SurfaceRegion region(Part part) const { return {std::span(surfaces_).subspan(part)}; }

  /// Largest number of segments of a flight. Longer flights are lost, such as those of light
  /// trapped by total reflection. The limit is higher for level surfaces, in which grazing light
  /// may be trapped for long.
  int most_segments() const { return most_segments_; }

  /// Distance at x below which two surfaces count as touching, so that a line crosses both at once.
  /// It is the accuracy with which the crossing of a line and a surface is computed.
  double contact(const Vec3& x) const {
    return crossing_accuracy(farthest_) + crossing_accuracy(x);
  }

  /// Lower bound of the distance from a point to the surface of its part; 0 if it takes long to
  /// compute.
  double clearance(const PathPoint& p) const {
    if (!has_fast_distance_[p.part]) return 0;
    double least = -distance(surfaces_[p.part], p.x);
    for (Part over = p.part + 1; over < parts(); ++over)
      least = std::min(least, distance(surfaces_[over], p.x));
    return least;
  }

  /// Returns the part at a position in the stage; on a surface, the part outside.
  Part at(const Vec3& x) const;
  /// Returns the part in which a line along d starts; on a surface, the part that it enters.
  Part at(const Vec3& x, const Vec3& d) const { return beyond(around, at_boundary, x, d); }

  /// Exit of a line from its part; the line starts in the part or on its surface.
  struct ExitPoint {
    double length;
    SegmentEnd end;
  };
  ExitPoint exit_distance(const PathPoint& p, const Vec3& d) const {
    ExitPoint exit{grin::exit_distance(surfaces_[p.part], p.x, d), p.part};
    for (Part over = p.part + 1; over < parts(); ++over)
      if (const double in = entry_distance(surfaces_[over], p.x, d); in < exit.length)
        exit = {in, over};
    return exit;
  }

  /// Returns the part that a line along d enters at x, on the surface of a body.
  Part beyond(Part part, SegmentEnd surface, const Vec3& x, const Vec3& d) const {
    for (Part to = parts() - 1; to > around; --to) {
      if (to == surface && part != surface) return to;
      if (to != surface && goes_into(to, x, d)) return to;
    }
    return around;
  }

 private:
  /// Whether a line along d is inside a body just beyond x. If x is in contact with the surface of
  /// the body, the direction decides.
  bool goes_into(Part body, const Vec3& x, const Vec3& d) const;

  std::vector<Surface> surfaces_;
  std::vector<bool> has_fast_distance_;  ///< by part: whether its surfaces are boxes and balls
  double farthest_ = 0;
  int most_segments_ = 1000;
};

/// Returns the relative density of a part's medium, averaged over points of a lattice.
double mean_density(const Stage& stage, Part part);

/// Throws InputError, naming the key, unless x, the position of a sensor or light, is inside the
/// stage or on its boundary, and not in an opaque body.
void require_in_stage(const Stage& stage, const char* key, const Vec3& x);

}  // namespace flatspeckle::grin
