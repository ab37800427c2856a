#pragma once

#include <optional>

#include "grin/space.h"

namespace flatspeckle::grin {

// Lights and sensors are the same to transport (reciprocity): both are ends of paths. A light end
// emits, per area and solid angle,        strength = n^2 cos(t) L~        (L~ = L/n^2, C24),
// a sensor whose pixel reads  integral W L~ n^2 cos(t) dA dw  takes   strength = n^2 cos(t) W.
// t is the angle from the inward normal. A point (a point light, a pinhole) has no area: strength
// per solid angle, position_density = 1.
//
// A path that joins the ends y (light) and z (sensor) through scattering contributes
//   [strength_y / density_y] [a p]... [strength_z / density_z]  times, for the joined curve,
//   transmittance multiplicity / (n_z^2 |J_yz|), and n_z^2 |J_yz| = n_y^2 |J_zy|.
// A path from one end that arrives on a surface end with direction d is worth
//   strength(x, -d) / (n^2 cos(t)).

/// A place where a path can begin.
struct EndPosition {
  PathPoint point;
  Vec3 inward = Vec3::Zero();   ///< unit normal into the stage; 0 of a point
  double position_density = 1;  ///< per area, chance of this light among the others included
  int light = 0;                ///< its number; 0 of the sensor
  bool is_point = false;        ///< cannot be hit
  bool is_beam = false;         ///< one direction only: can neither be joined nor hit
};

/// One direction of light away from an end (for a sensor: against the light).
struct EndDirection {
  Vec3 direction;       ///< unit
  double density = 0;   ///< per solid angle, that sampling it has; 0 of a beam
  double strength = 0;  ///< see above; of a beam the power times position_density
  int pixel = -1;       ///< of a sensor
};

/// An end as a path from the other end hits it.
struct EndHit {
  EndPosition position;
  EndDirection direction;  ///< direction points into the stage, against the path that hit
  double value = 0;        ///< strength / (n^2 cos t)
};

}  // namespace flatspeckle::grin
