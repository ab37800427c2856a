#pragma once

#include "grin/render/stage/flight.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

// Lights and sensors are the same to transport (reciprocity): both are ends of paths. A light end
// emits, per area and solid angle,        strength = n^2 cos(t) L~        (L~ = L/n^2, C24),
// a sensor whose pixel reads  integral W L~ n^2 cos(t) dA dw  takes   strength = n^2 cos(t) W.
// t is the angle from the inward normal. A point (a point light, a pinhole) has no area: strength
// per solid angle, position_density the chance of the light. A beam has one direction: strength per
// area, and the density of its direction is 1.
//
// A path that joins the ends y (light) and z (sensor) through scattering contributes
//   [strength_y / density_y] [a p]... [strength_z / density_z]  times, for the joined curve,
//   transmittance multiplicity / (n_z^2 |J_yz|), and n_z^2 |J_yz| = n_y^2 |J_zy|,
// where density = position_density * direction's density, without the latter for an end that is
// itself joined. A path from one end that arrives on a surface end with direction d is worth
//   strength(x, -d) / (n^2 cos(t)).

/// A place where a path can begin.
struct EndPosition {
  PathPoint point;
  Vec3 inward = Vec3::Zero();   ///< unit normal into the stage; 0 of a point
  double position_density = 1;  ///< per area, chance of this light among the others included
  double index = 1;             ///< at the point
  int light = 0;                ///< its number; 0 of the sensor
  int pixel = -1;               ///< of a sensor whose positions have pixels
  bool is_point = false;        ///< cannot be hit
  bool is_beam = false;         ///< one direction only: can neither be joined nor hit
  /// Of a place chosen for a join from somewhere: the density of that choice over position_density.
  double choice = 1;
};

/// One direction of light away from an end (for a sensor: against the light).
struct EndDirection {
  Vec3 direction;       ///< unit
  double density = 0;   ///< per solid angle, that sampling it has; 1 of a beam
  double strength = 0;  ///< see above
  int pixel = -1;       ///< of a sensor; -1 where it does not look, and then the strength is 0
};

/// An end as a path from the other end hits it.
struct EndHit {
  EndPosition position;
  EndDirection direction;  ///< direction points into the stage, against the path that hit
  double value = 0;        ///< strength / (n^2 cos t)
};

/// The hit on a surface end whose strength away from it is known. Grazing light does not hit.
template <class Use>
void use_hit(const EndPosition& at, const EndDirection& back, const Use& use) {
  const double cosine = back.direction.dot(at.inward);
  if (cosine > 0 && back.strength > 0)
    use(EndHit{at, back, back.strength / (at.index * at.index * cosine)});
}

}  // namespace flatspeckle::grin
