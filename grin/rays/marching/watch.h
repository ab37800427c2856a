#pragma once

#include <cstdint>
#include <span>

#include "grin/rays/marching/ray.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// The sides of surfaces that a ray is known to be on, however close to them it is; bit i is of
/// surface i. What is ignored is not met.
struct KnownSides {
  std::uint64_t inside = 0, outside = 0, ignored = 0;

  bool ignores(std::size_t surface) const { return ignored >> surface & 1; }
};

/// Where a ray ends, lengths in the units of the scene.
struct TraceLimits {
  double max_arc_length;     ///< from the trace's start
  double tolerance = 1e-10;  ///< to which an end is located; on a surface then to rounding
  long max_steps = 10'000'000;
  KnownSides sides = {};
};

enum class Stop {
  surface,  ///< on a surface, within the tolerance
  length,   ///< at the full arc length, within the tolerance
  steps,    ///< after so many steps
  lost      ///< an index that is not positive, or no step short enough
};

struct TraceEnd {
  Stop stop;
  int surface = -1;  ///< number of the surface, where it stopped on one
  long steps = 0;
  long looks = 0;  ///< times that surfaces were asked for their distance
};

/// Tells how far a ray may go before it meets one of the surfaces, or its full length.
class Watch {
 public:
  static constexpr std::size_t max_surfaces = 64;

  /// The side of each surface, unless it is known, is the one that `start` is on, or leaves to
  /// where it is within the tolerance of the surface. Throws InputError for too many surfaces.
  Watch(std::span<const Surface> surfaces, const TraceLimits& limits, const RayState& start);

  /// The side of a surface that the ray is on, or goes to.
  bool is_inside(std::size_t surface) const { return inside_ >> surface & 1; }

  /// Positive until the first crossing, and no more than the arc that is left to it.
  double clearance(const RayState& ray) const;

  /// The surface that is closest, or -1 for the full length.
  int nearest(const RayState& ray) const;

 private:
  double clearance(std::size_t i, const Vec3& x) const;

  std::span<const Surface> surfaces_;
  double tolerance_, last_arc_length_;
  KnownSides known_;
  std::uint64_t inside_ = 0, on_surface_ = 0;
};

/// Moves the end of a ray, found to a tolerance, on to the surface or back to it, to rounding.
/// inside: the side that the ray came from.
void settle(const Surface& surface, bool inside, double tolerance, RayState& ray);

}  // namespace flatspeckle::grin
