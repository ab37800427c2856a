#pragma once

#include "grin/render/stage/flight.h"

namespace flatspeckle::grin {

/// Where a ray meets the surface of a body, and the part beyond.
struct Meeting {
  LegEnd surface;
  Part beyond;
};

/// A way between two points that is refracted or reflected.
struct Way {
  Vec3 start_direction, end_direction;  ///< unit tangents along the way
  double spreading;                     ///< |J| from start to end
  int orientation;                      ///< sign of the determinant in J
  double arc_length, optical_path;
  Passages passages;
  double chance;  ///< Fresnel's, that light takes these passages
  int hollows;    ///< of these, at surfaces that are not convex
  double sigma;   ///< of the last leg, ray parameter
};

/// Where a leg crosses the plane of parallel light.
struct PlaneCrossing {
  bool is_reached = false;  ///< on the way of the ray
  double sigma = 0;         ///< of the leg, ray parameter
};

}  // namespace flatspeckle::grin
