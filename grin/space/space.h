#pragma once

#include <optional>

#include "core/numbers/random.h"
#include "grin/connections/connection.h"
#include "grin/geometry/vec3.h"

namespace flatspeckle::grin {

/// What a point lies in.
enum class Part { stage, body };

struct PathPoint {
  Vec3 x;
  Part part = Part::stage;
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
  double optical_depth = 0;   ///< integral of the reference extinction along the way
  double weight = 1;          ///< exp(-mu_a s) in media that do not scatter, else 1
  bool crosses_body = false;  ///< passes its surface or is reflected there
  bool is_joinable = true;    ///< a join of its ends finds the same way
};

/// A curve that joins two points.
struct Join {
  Vec3 start_direction, end_direction;  ///< unit tangents along the way from the first point
  double spreading;                     ///< |J_PQ|
  double optical_path;
  double optical_depth;  ///< integral of the reference extinction along the way
  double transmittance;  ///< or an unbiased estimate of it, where the density is a grid
  double multiplicity;   ///< K of C26: f multiplicity is unbiased for the sum of f over the curves
};

// The reference extinction of a part that scatters: mu_t, or mu_t times the mean in it of the
// relative density where that is a grid; of a part that does not: 0, as no flight ends there.
// Weights of multiple importance sampling use it in place of the true one, which leaves them
// weights and needs no second estimate.

/// What the estimators ask of space. StraightSpace<plan> answers inline; CurvedSpace (abstract) by
/// one virtual call per flight, behind which the field's type is known to every step.
template <class S>
concept Space = requires(const S& space, const PathPoint& p, const Vec3& v, RandomStream& random,
                         ConnectionStatistics& statistics) {
  { space.index(p) } -> std::convertible_to<double>;
  { space.fly(p, v, random) } -> std::same_as<Flight>;
  { space.joins_all() } -> std::same_as<bool>;
  { space.can_join(p, p) } -> std::same_as<bool>;
  { space.least_depth(p, p) } -> std::same_as<double>;
  { space.join(p, p, random, statistics) } -> std::same_as<std::optional<Join>>;
};

}  // namespace flatspeckle::grin
