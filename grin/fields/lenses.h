#pragma once

#include <cmath>

#include "grin/fields/radial_field.h"

namespace flatspeckle::grin {

/// Luneburg 1944: n^2 = 2 - r^2/a^2 up to the rim, 1 outside. The gradient jumps at the rim, where
/// a ray should be stopped and started again. `beyond`: how far past the rim, relative, the formula
/// goes on: a hair, so that a ray may start from the rim; up to 0.4 where rays are stopped there
/// anyhow and steps that reach past it should stay smooth.
struct LuneburgProfile {
  double radius = 1;
  double beyond = 1e-9;

  double excess(double u) const {
    const double q = u / (radius * radius);
    return is_inside(q) ? (1 - q) / (1 + std::sqrt(2 - q)) : 0;
  }
  RadialJet jet(double u) const {
    const double area = radius * radius, q = u / area;
    if (!is_inside(q)) return {0, 0, 0};
    const double n = std::sqrt(2 - q);
    return {(1 - q) / (1 + n), -1 / (2 * area * n), -1 / (4 * area * area * n * n * n)};
  }

 private:
  bool is_inside(double q) const { return q <= (1 + beyond) * (1 + beyond); }
};
using Luneburg = RadialField<LuneburgProfile, 3>;

/// Maxwell's fisheye, n = n0 / (1 + r^2/a^2); n0 is 1 + centre_excess.
struct FisheyeProfile {
  double centre_excess = 1, radius = 1;

  double excess(double u) const {
    const double q = u / (radius * radius);
    return (centre_excess - q) / (1 + q);
  }
  RadialJet jet(double u) const {
    const double area = radius * radius, q = u / area, w = 1 / (1 + q);
    const double first = -(1 + centre_excess) * w * w / area;
    return {(centre_excess - q) * w, first, -2 * first * w / area};
  }
};
using Fisheye = RadialField<FisheyeProfile, 3>;

}  // namespace flatspeckle::grin
