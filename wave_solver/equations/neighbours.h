#pragma once

#include <vector>

#include "flatland/placement/placement.h"

namespace flatspeckle::wave {

/// What comes closest to a scatterer.
struct Neighbour {
  std::size_t scatterer = 0;  ///< itself if it is alone
  double distance = 0;        ///< of the centres; infinite if alone
};

/// Of every scatterer, the one whose images of it come closest (nearest_image). Linear in their
/// number where they are about evenly spread.
std::vector<Neighbour> nearest_neighbours(const Placement& placement);

/// Distance from the centre of disk a at which its images in disk b accumulate, reflected outwards:
/// a exp(xi), sinh xi = c/a in bipolar coordinates of focal distance c.
double nearest_image(double radius_a, double radius_b, double distance);

}  // namespace flatspeckle::wave
