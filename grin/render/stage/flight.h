#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/random.h"
#include "grin/rays/connections/connection.h"
#include "grin/render/stage/regions.h"

namespace flatspeckle::grin {

/// Where a way of light is refracted or reflected at surfaces of bodies, one after the other; those
/// where the index does not jump are none.
struct Passages {
  int count = 0;
  std::uint32_t reflected = 0;  ///< bit i: the i-th is a reflection

  /// Of ways that can be joined.
  static constexpr int most = 16;

  bool reflects(int i) const { return (reflected >> i) & 1; }
  Passages reversed() const {
    Passages back;
    for (int i = count; i-- > 0;) back.add(reflects(i));
    return back;
  }
  void add(bool reflects) {
    reflected |= static_cast<std::uint32_t>(reflects) << count;
    ++count;
  }
  bool operator==(const Passages&) const = default;
};

/// The way of light from a point to the next event, along a curve, through surfaces of bodies where
/// it meets them.
struct Flight {
  enum class End {
    collision,  ///< in a medium
    boundary,   ///< left the stage; `point` is on the boundary
    lost        ///< no ray (index not positive, or too many steps): counted, contributes nothing
  };
  End end = End::lost;
  PathPoint point;                      ///< where it ended
  Vec3 start_direction = Vec3::Zero();  ///< unit
  Vec3 direction = Vec3::Zero();        ///< unit tangent at the end
  double arc_length = 0, optical_path = 0;
  double spreading = 0;         ///< |J| from start to end (C25); 0 where no join finds it
  double optical_depth = 0;     ///< reference depth, see below
  double weight = 1;            ///< exp(-mu_a s) in media that do not scatter, else 1
  double stretched = 1;         ///< density of plain flights over that of those sampled
  double absorbed_in_body = 0;  ///< in any; of 1 - weight
  bool crosses_body = false;    ///< passes the surface of one or is reflected there
  Passages passages = {};       ///< there, where it refracts; of a way that joins can find
  double fresnel = 1;           ///< chance of these
  int hollows = 0;              ///< of these, at surfaces that are not convex
  bool is_joinable = true;      ///< a join of its ends finds the same way
};

/// A curve that joins two points.
struct Join {
  Vec3 start_direction, end_direction;  ///< unit tangents along the way from the first point
  double spreading;                     ///< |J_PQ|
  double optical_path = 1;
  double optical_depth = 0;  ///< reference depth, see below
  double transmittance = 1;  ///< or an unbiased estimate of it, where the density is a grid; and
                             ///< the chance of what happens at surfaces of bodies, Fresnel's
  double multiplicity =
      1;  ///< K of C26: f multiplicity is unbiased for the sum of f over the curves
  Passages passages = {};  ///< of surfaces that refract, found by search
  double fresnel = 1;      ///< chance of these
  int hollows = 0;         ///< of these, at surfaces that are not convex
};

/// Light of one direction, at the plane across it through x.
struct ParallelLight {
  Vec3 x, direction;  ///< unit
};

/// A way from a point to where parallel light comes from.
struct BeamWay {
  Vec3 start_direction;           ///< unit tangent, against the light
  Vec3 place;                     ///< on the plane
  Vec3 first_met = Vec3::Zero();  ///< where it is refracted or reflected first, if it is
  double thinning;                ///< area across the light at the point per area at the plane
  int orientation;                ///< sign of the determinant in it
  double arc_length, optical_path;
  Passages passages = {};
  double transmittance;      ///< or an unbiased estimate; Fresnel's alone where not stated
  double multiplicity = 1;   ///< as in Join
  double optical_depth = 0;  ///< reference depth, see below; 0 where not stated
};

/// Where a search for ways to parallel light begins: along a direction, or from outside of all
/// bodies towards the place where it is first refracted or reflected.
struct BeamSeed {
  Vec3 start_direction;
  Passages passages = {};
  Vec3 first_met = Vec3::Zero();
};

// The reference depth of a way is the integral of the reference extinction along it, and -ln of the
// chance of its refractions and reflections. The reference extinction of a part that scatters:
// mu_t, or mu_t times the mean in it of the relative density where that is a grid; of a part that
// does not: 0, as no flight ends there. Weights of multiple importance sampling use it in place of
// the true one, which leaves them weights and needs no second estimate.

}  // namespace flatspeckle::grin
