#include "wave_solver/equations/neighbours.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flatland/placement/cell_grid.h"

namespace flatspeckle::wave {

namespace {

constexpr double far_away = std::numeric_limits<double>::infinity();

struct DiskExtent {
  double width = 0;  // of the square that holds the centres
  double largest_radius = 0;
};

DiskExtent extent_of(const Placement& placement) {
  Vec2 low{far_away, far_away}, high{-far_away, -far_away};
  DiskExtent extent;
  for (const auto& [position, scatterer] : placement) {
    low = {std::min(low.x, position.x), std::min(low.z, position.z)};
    high = {std::max(high.x, position.x), std::max(high.z, position.z)};
    extent.largest_radius = std::max(extent.largest_radius, scatterer.disk_radius());
  }
  extent.width = std::max(high.x - low.x, high.z - low.z);
  return extent;
}

struct Candidate {
  Neighbour neighbour;
  double image = far_away;
};

Candidate nearest_in(const CellGrid& grid, const Placement& placement, std::size_t j) {
  const Vec2 position = placement[j].position;
  const double radius = placement[j].scatterer.disk_radius();
  Candidate best{{j, far_away}, far_away};
  grid.any_near(position, [&](Vec2 other, std::size_t l) {
    if (l == j) return false;
    const double distance = length(other - position);
    const double image = nearest_image(radius, placement[l].scatterer.disk_radius(), distance);
    if (image < best.image) best = {{l, distance}, image};
    return false;
  });
  return best;
}

}  // namespace

double nearest_image(double a, double b, double d) {
  const double sum = a + b, difference = a - b;
  const double squares = (d - sum) * (d + sum) * (d - difference) * (d + difference);
  const double c = std::sqrt(std::max(0.0, squares)) / (2 * d);
  return c + std::hypot(c, a);
}

// Cells are widened for those that have nothing close enough to rule out all that lies farther
// away.
std::vector<Neighbour> nearest_neighbours(const Placement& placement) {
  std::vector<Neighbour> nearest(placement.size());
  std::vector<std::size_t> left;
  for (std::size_t j = 0; j < placement.size(); ++j) left.push_back(j);
  const DiskExtent extent = extent_of(placement);
  const double spacing = extent.width / std::sqrt(static_cast<double>(placement.size()));
  for (double cell = std::max({spacing, 2.5 * extent.largest_radius, 1e-300}); !left.empty();
       cell *= 2) {
    CellGrid grid(cell);
    for (std::size_t l = 0; l < placement.size(); ++l) grid.insert(placement[l].position, l);
    const bool all = cell > extent.width;
    std::erase_if(left, [&](std::size_t j) {
      const Candidate best = nearest_in(grid, placement, j);
      nearest[j] = best.neighbour;
      const double radius = placement[j].scatterer.disk_radius();
      return all || best.image <= nearest_image(radius, extent.largest_radius, cell);
    });
  }
  return nearest;
}

}  // namespace flatspeckle::wave
