#pragma once

#include <cstdint>
#include <span>

#include "grin/rays/marching/ray.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// Sides of surfaces on which a ray is known to be, even if it is very close to the surfaces. Bit i
/// stands for surface i. Rays never meet ignored surfaces.
struct KnownSides {
  std::uint64_t inside = 0, outside = 0, ignored = 0;

  bool ignores(std::size_t surface) const { return ignored >> surface & 1; }
};

/// Limits of a ray; lengths in the units of the scene.
struct TraceLimits {
  double max_arc_length;  ///< largest arc length, measured from the start of the trace
  /// Tolerance, as a length, to which the end of a ray is located along the ray. An end on a
  /// surface is afterwards moved onto it, exact to rounding.
  double tolerance = 1e-10;
  long max_steps = 10'000'000;
  KnownSides sides = {};
};

enum class Stop {
  surface,  ///< the ray ended on a surface, within the tolerance
  length,   ///< the ray ended at its largest arc length, within the tolerance
  steps,    ///< the trace ended after max_steps steps
  lost      ///< the ray is lost: the index is not positive, or no step is short enough
};

struct TraceEnd {
  Stop stop;
  int surface = -1;  ///< number of the surface on which the ray stopped; -1: on no surface
  long steps = 0;
  long distance_evaluations = 0;  ///< number of evaluations of the clearance from the surfaces
};

/// Computes how far a ray may go before it meets one of the surfaces or reaches its largest arc
/// length.
class Watch {
 public:
  static constexpr std::size_t max_surfaces = 64;

  /// Determines on which side of each surface the ray is, unless limits.sides specifies it. This is
  /// the side of the start or, if the ray starts on a surface within the tolerance, the side
  /// towards which the ray goes. Throws InputError for too many surfaces.
  Watch(std::span<const Surface> surfaces, const TraceLimits& limits, const RayState& start);

  /// Whether the ray is inside a surface, or starts on it and goes inside.
  bool is_inside(std::size_t surface) const { return inside_ >> surface & 1; }

  /// Returns a lower bound of the arc length that remains until the ray meets a surface or reaches
  /// its largest arc length. The bound is positive before this point.
  double clearance(const RayState& ray) const;

  /// Returns the index of the closest surface, or -1 if the ray reaches its largest arc length
  /// first.
  int nearest(const RayState& ray) const;

 private:
  double clearance(std::size_t i, const Vec3& x) const;

  std::span<const Surface> surfaces_;
  double tolerance_, last_arc_length_;
  KnownSides known_;
  std::uint64_t inside_ = 0, on_surface_ = 0;
};

/// Moves the end of a ray, which is known within the tolerance, forward or back along the ray onto
/// the surface, exact to rounding. inside: whether the ray came from the inside of the surface.
void settle(const Surface& surface, bool inside, double tolerance, RayState& ray);

}  // namespace flatspeckle::grin
