#pragma once

#include <optional>
#include <vector>

#include "grin/rays/surfaces/room.h"
#include "grin/rays/surfaces/straight_way.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

struct PathPoint {
  Vec3 x = Vec3::Zero();
  Part part = around;
};

/// Where a leg within one part ends: in a collision, or on a surface, which has the number of its
/// body, the boundary that of what is around the bodies.
using LegEnd = int;
inline constexpr LegEnd at_collision = -1, at_boundary = 0;

/// Which part of a stage a place lies in, and where straight lines leave that.
class Regions {
 public:
  /// farthest: the largest coordinate of where lines start, if not that of the stage's boundary.
  explicit Regions(const Stage& stage, std::optional<double> farthest = {});

  Part parts() const { return static_cast<Part>(surfaces_.size()); }
  const Surface& surface(LegEnd number) const { return surfaces_[number]; }
  /// What a part lies in: its surface, and those of the bodies that lie over it.
  Room room(Part part) const { return {std::span(surfaces_).subspan(part)}; }

  /// Light goes on through surfaces so often at the most: what total reflection traps is lost. What
  /// has grazed a level surface that is not quite round may take its time to get out again.
  int most_legs() const { return most_legs_; }

  /// Surfaces that are as close to a place where a line crosses one of them are in contact, and
  /// crossed together. It is the accuracy of the place: two surfaces farther apart are two.
  double contact(const Vec3& x) const {
    return crossing_accuracy(farthest_) + crossing_accuracy(x);
  }

  /// Of a place in the stage; on surfaces that around them.
  Part at(const Vec3& x) const;
  /// The same of a line that starts there; on surfaces that which it goes into.
  Part at(const Vec3& x, const Vec3& d) const { return beyond(around, at_boundary, x, d); }

  /// From a point of a part, or on its surface, to where it ends.
  struct WayOut {
    double length;
    LegEnd end;
  };
  WayOut way_out(const PathPoint& p, const Vec3& d) const {
    WayOut way{grin::way_out(surfaces_[p.part], p.x, d), p.part};
    for (Part over = p.part + 1; over < parts(); ++over)
      if (const double in = way_in(surfaces_[over], p.x, d); in < way.length) way = {in, over};
    return way;
  }

  /// The part that begins where a line along d leaves another at x, on the surface of a body.
  Part beyond(Part part, LegEnd surface, const Vec3& x, const Vec3& d) const {
    for (Part to = parts() - 1; to > around; --to) {
      if (to == surface && part != surface) return to;
      if (to != surface && goes_into(to, x, d)) return to;
    }
    return around;
  }

 private:
  /// Where a surface is in contact, by the direction.
  bool goes_into(Part body, const Vec3& x, const Vec3& d) const;

  std::vector<Surface> surfaces_;
  double farthest_ = 0;
  int most_legs_ = 1000;
};

/// The relative density of a part's medium, averaged over points of a lattice.
double mean_density(const Stage& stage, Part part);

/// Throws InputError unless a sensor here is inside the stage or on its boundary.
void require_in_stage(const Stage& stage, const Vec3& x);

}  // namespace flatspeckle::grin
