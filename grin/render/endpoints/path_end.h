#pragma once

#include "grin/render/stage/flight.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

// Transport treats lights and sensors alike (reciprocity): both are endpoints of paths. A light
// emits, per area and solid angle,        strength = n^2 cos(t) L~        (L~ = L/n^2, C24),
// a sensor with pixel value  integral W L~ n^2 cos(t) dA dw  has      strength = n^2 cos(t) W.
// t is the angle from the inward normal. A point light or a pinhole has no area: its strength is
// per solid angle, and its position_density is the probability of the light. A beam has one
// direction: its strength is per area, and the density of its direction is 1.
//
// A path between the endpoints y (light) and z (sensor), with a factor albedo times phase function,
// a p, for each scattering, contributes
//   [strength_y / density_y] [a p]... [strength_z / density_z]  times, for the connecting curve,
//   transmittance multiplicity / (n_z^2 |J_yz|), and n_z^2 |J_yz| = n_y^2 |J_zy|,
// where density is position_density times the density of the direction. The density of the
// direction is left out for an endpoint that is itself connected. A path that hits a surface
// endpoint with direction d contributes
//   strength(x, -d) / (n^2 cos(t)).

/// A position where a path can begin.
struct EndPosition {
  PathPoint point;
  Vec3 inward = Vec3::Zero();  ///< unit normal into the stage; 0 for a point light or pinhole
  /// Density of sampling the position, per area; includes the probability of this light.
  double position_density = 1;
  double index = 1;       ///< index of refraction at the point
  int light = 0;          ///< number of the light; 0 for a sensor
  int pixel = -1;         ///< pixel, if the pixels of the sensor are areas; else -1
  bool is_point = false;  ///< true for a point: paths cannot hit it
  /// True for a beam, which has a single direction: sampled paths neither hit it nor connect to it.
  bool is_beam = false;
  bool surrounds = false;  ///< true for a light that covers the whole boundary
  /// For a position chosen for a connection from a given point: density with which it was chosen,
  /// divided by position_density; else 1.
  double choice = 1;
};

/// A direction in which a path leaves an endpoint (at a sensor, opposite to the light).
struct EndDirection {
  Vec3 direction;       ///< unit
  double density = 0;   ///< density of sampling the direction, per solid angle; 1 for a beam
  double strength = 0;  ///< as defined at the top of this file
  int pixel = -1;       ///< pixel of a sensor; -1 outside its view, where the strength is 0
};

/// A hit on an endpoint (light or sensor) by a path that began at the other endpoint.
struct EndHit {
  EndPosition position;
  EndDirection direction;  ///< direction of the path that hit, reversed: into the stage
  double value = 0;        ///< strength / (n^2 cos t)
};

/// Calls use(EndHit) if a path hits the surface endpoint at this position. back: direction of the
/// path, reversed. Light parallel to the surface does not hit.
template <class Use>
void use_hit(const EndPosition& at, const EndDirection& back, const Use& use) {
  const double cosine = back.direction.dot(at.inward);
  if (cosine > 0 && back.strength > 0)
    use(EndHit{at, back, back.strength / (at.index * at.index * cosine)});
}

}  // namespace flatspeckle::grin
