#pragma once

#include <vector>

#include "flatland/placement/placement.h"

namespace flatspeckle::wave {

/// What comes close to a scatterer.
struct Neighbour {
  std::size_t scatterer = 0;
  double distance = 0;  ///< of the centres
  double image = 0;     ///< nearest_image of the scatterer in this neighbour
};

/// Of every scatterer, those around it whose images of it come closest, in this order: the closest
/// of each of up to `different` different scatterers. The first is the closest of all; others are
/// those within about the largest diameter or the mean distance. Empty for one that is alone.
/// Linear in their number where they are about evenly spread.
std::vector<std::vector<Neighbour>> neighbours(const Placement& placement,
                                               std::size_t different = 12);

/// Distance from the centre of disk a at which its images in disk b accumulate, reflected outwards:
/// a exp(xi), sinh xi = c/a in bipolar coordinates of focal distance c.
double nearest_image(double radius_a, double radius_b, double distance);

}  // namespace flatspeckle::wave
