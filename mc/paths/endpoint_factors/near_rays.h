#pragma once

#include <vector>

#include "core/numbers/random.h"
#include "flatland/media/domain.h"
#include "flatland/request/light.h"
#include "mc/paths/endpoint_factors/extinction.h"
#include "mc/paths/endpoint_factors/gaussian_beam.h"

namespace flatspeckle::mc {

/// The part of a ray from an origin that lies in the medium.
struct Chord {
  double enter, leave;
  double length() const { return leave - enter; }
};
/// Through a box, for enter >= least; no longer than 0 where the ray misses it.
Chord chord_through(const Domain& box, Vec2 origin, Vec2 w, double least);

/// First scatterers of a point source in a box or outside it: uniform in angle over what the box
/// subtends, attenuated along the ray.
class PointRays {
 public:
  PointRays(const Domain& box, const Extinction& extinction, Vec2 source);

  Vec2 sample(RandomStream& random) const;
  double density(Vec2 x) const;  ///< per area
  Vec2 arrival(Vec2 x) const;

 private:
  Domain box_;
  Extinction extinction_;
  Vec2 source_;
  double first_angle_, wedge_;
};

/// First scatterers of a beam in a box: Gaussian across, of the intensity's width at one distance
/// from the focus, attenuated along the axis.
class BeamRays {
 public:
  BeamRays(const Domain& box, const Extinction& extinction, const GaussianBeam& beam, double width);

  /// Whether the box lies beyond two widths.
  bool misses() const { return nearest_ > 4 * sigma_; }
  Vec2 sample(RandomStream& random) const;
  double density(Vec2 x) const;  ///< per area
  Vec2 arrival(Vec2 x) const { return beam_.ray(x); }

 private:
  double sample_across(RandomStream& random) const;

  Domain box_;
  Extinction extinction_;
  GaussianBeam beam_;
  double sigma_, low_, high_;  ///< of the coordinate across; between them it meets the box
  double nearest_;             ///< the least |coordinate across| of them
  double share_;               ///< of the Gaussian that lies between them
};

/// Of the narrowest and the widest that the beam is in the box: together they cover it. Throws
/// InputError for a beam that misses the box.
std::vector<BeamRays> beam_rays(const Domain& box, const Extinction& extinction,
                                const GaussianBeam& beam);

}  // namespace flatspeckle::mc
