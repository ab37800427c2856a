#pragma once

#include <vector>

#include "flatland/placement/placement.h"

namespace flatspeckle::wave {

/// A scatterer close to another one.
struct Neighbour {
  std::size_t scatterer = 0;
  double distance = 0;  ///< distance between the two centres
  double image = 0;     ///< nearest_image(), with the scatterer as disk a, its neighbour as b
};

/// Returns, for each scatterer, its closest neighbours, sorted by Neighbour::image. Of equal
/// neighbours (kind, radius and index) only the closest is listed; at most `different` neighbours
/// are listed. The first neighbour is the closest of all scatterers; the others are searched within
/// about the largest diameter or the mean spacing. The list is empty if there is only one
/// scatterer. The cost is linear in the number of scatterers if they are about evenly spread.
std::vector<std::vector<Neighbour>> neighbours(const Placement& placement,
                                               std::size_t different = 12);

/// Returns the distance from the centre of disk a to the point in disk b at which image charges
/// accumulate (in statics) if charges are reflected again and again in both disks. It is a exp(xi)
/// with sinh(xi) = c / a, where c is the focal distance of the bipolar coordinates of the two
/// disks.
double nearest_image(double radius_a, double radius_b, double distance);

}  // namespace flatspeckle::wave
