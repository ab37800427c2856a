#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "flatland/media/domain.h"
#include "flatland/media/structure_factor.h"

namespace flatspeckle::tests {

/// Returns p / (rho k T) = 1 + 2 eta g(contact).
inline double compressibility_factor(double packing) {
  return 1 + 2 * packing * HardDiskFluid(packing, 1).contact_value();
}

/// Returns the square box in which the given number of disks of diameter 1 has a packing fraction.
inline Domain unit_disk_box(std::size_t disks, double packing) {
  const double side = std::sqrt(static_cast<double>(disks) * std::numbers::pi / (4 * packing));
  return {Domain::Kind::box, side, side};
}

/// Returns the distance to the nearest periodic image.
inline double periodic_distance(const Domain& box, Vec a, Vec b) {
  const Vec d = a - b;
  const double x = d.x - box.width * std::floor(d.x / box.width + 0.5);
  const double z = d.z - box.depth * std::floor(d.z / box.depth + 0.5);
  const double y = box.height > 0 ? d.y - box.height * std::floor(d.y / box.height + 0.5) : 0;
  return std::sqrt(x * x + z * z + y * y);
}

/// Adds to counts[b] the pairs (j < i) with distances in [start + b width, start + (b + 1) width).
inline void count_pairs(const Domain& box, std::span<const Vec> centres, double start, double width,
                        std::span<double> counts) {
  for (std::size_t i = 0; i < centres.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double bin = (periodic_distance(box, centres[i], centres[j]) - start) / width;
      if (bin >= 0 && bin < static_cast<double>(counts.size()))
        counts[static_cast<std::size_t>(bin)] += 1;
    }
}

}  // namespace flatspeckle::tests
