#pragma once

#include <cstdint>
#include <optional>

#include "core/numbers/random.h"
#include "grin/connections/connection.h"
#include "grin/geometry/vec3.h"

namespace flatspeckle::grin {

/// What a point lies in.
enum class Part { stage, body };

/// The other side of the body's surface.
inline Part beyond(Part part) {
  return part == Part::body ? Part::stage : Part::body;
}

struct PathPoint {
  Vec3 x;
  Part part = Part::stage;
};

/// Where a way of light is refracted or reflected at the body's surface, one after the other.
struct Passages {
  int count = 0;
  std::uint32_t reflected = 0;  ///< bit i: the i-th is a reflection

  /// Of ways that can be joined.
  static constexpr int most = 16;

  bool reflects(int i) const { return (reflected >> i) & 1; }
  void add(bool reflects) {
    reflected |= static_cast<std::uint32_t>(reflects) << count;
    ++count;
  }
  bool operator==(const Passages&) const = default;
};

/// The way of light from a point to the next event, along a curve, through the body's surface where
/// it meets that.
struct Flight {
  enum class End {
    collision,  ///< in a medium
    boundary,   ///< left the stage; `point` is on the boundary
    lost        ///< no ray (index not positive, or too many steps): counted, contributes nothing
  };
  End end = End::lost;
  PathPoint point;       ///< where it ended
  Vec3 start_direction;  ///< unit
  Vec3 direction;        ///< unit tangent at the end
  double arc_length = 0, optical_path = 0;
  double spreading = 0;       ///< |J| from start to end (C25); 0 where no join finds it
  double optical_depth = 0;   ///< reference depth, see below
  double weight = 1;          ///< exp(-mu_a s) in media that do not scatter, else 1
  bool crosses_body = false;  ///< passes its surface or is reflected there
  int passages = 0;           ///< there, where it refracts
  bool is_joinable = true;    ///< a join of its ends finds the same way
};

/// A curve that joins two points.
struct Join {
  Vec3 start_direction, end_direction;  ///< unit tangents along the way from the first point
  double spreading;                     ///< |J_PQ|
  double optical_path;
  double optical_depth;  ///< reference depth, see below
  double transmittance;  ///< or an unbiased estimate of it, where the density is a grid; and the
                         ///< chance of what happens at the body's surface, Fresnel's
  double multiplicity;   ///< K of C26: f multiplicity is unbiased for the sum of f over the curves
  bool passes = false;   ///< the body's surface, found by search
};

// The reference depth of a way is the integral of the reference extinction along it, and -ln of the
// chance of its refractions and reflections. The reference extinction of a part that scatters:
// mu_t, or mu_t times the mean in it of the relative density where that is a grid; of a part that
// does not: 0, as no flight ends there. Weights of multiple importance sampling use it in place of
// the true one, which leaves them weights and needs no second estimate.

/// What the estimators ask of space. join() finds ways that the body's surface leaves alone,
/// join_through() one of those that are refracted or reflected there. StraightSpace<plan> answers
/// inline; CurvedSpace (abstract) by one virtual call per flight, behind which the field's type is
/// known to every step.
template <class S>
concept Space = requires(const S& space, const PathPoint& p, const Vec3& v, RandomStream& random,
                         ConnectionStatistics& statistics) {
  { space.index(p) } -> std::convertible_to<double>;
  { space.fly(p, v, random) } -> std::same_as<Flight>;
  { space.joins_all() } -> std::same_as<bool>;
  { space.can_join(p, p) } -> std::same_as<bool>;
  { space.least_depth(p, p) } -> std::same_as<double>;
  { space.join(p, p, random, statistics) } -> std::same_as<std::optional<Join>>;
  { space.joins_through() } -> std::same_as<bool>;
  { space.join_through(p, p, random, statistics) } -> std::same_as<std::optional<Join>>;
};

}  // namespace flatspeckle::grin
