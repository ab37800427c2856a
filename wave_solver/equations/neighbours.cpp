#include "wave_solver/equations/neighbours.h"

#include <algorithm>
#include <cmath>

#include "flatland/placement/cell_grid.h"

namespace flatspeckle::wave {

namespace {

// Inserts a candidate into a list sorted by Neighbour::image. Of equal scatterers only the one with
// the smallest Neighbour::image is kept.
void enter(const Neighbour& candidate, const Placement& placement, std::size_t most,
           std::vector<Neighbour>& found) {
  const auto place = std::find_if(found.begin(), found.end(), [&](const Neighbour& other) {
    return candidate.image < other.image;
  });
  const auto is_equal = [&](const Neighbour& other) {
    return placement[other.scatterer].scatterer == placement[candidate.scatterer].scatterer;
  };
  if (std::any_of(found.begin(), place, is_equal)) return;
  const auto after = found.insert(place, candidate) + 1;
  found.erase(std::remove_if(after, found.end(), is_equal), found.end());
  if (found.size() > most) found.pop_back();
}

std::vector<Neighbour> found_in(const CellGrid& grid, const Placement& placement, std::size_t j,
                                std::size_t most) {
  const Vec position = placement[j].position;
  const double radius = placement[j].scatterer.disk_radius();
  std::vector<Neighbour> found;
  grid.any_near(position, [&](Vec other, std::size_t l) {
    if (l == j) return false;
    const double distance = length(other - position);
    const double image = nearest_image(radius, placement[l].scatterer.disk_radius(), distance);
    enter({l, distance, image}, placement, most, found);
    return false;
  });
  return found;
}

}  // namespace

double nearest_image(double a, double b, double d) {
  const double sum = a + b, difference = a - b;
  const double squares = (d - sum) * (d + sum) * (d - difference) * (d + difference);
  const double c = std::sqrt(std::max(0.0, squares)) / (2 * d);
  return c + std::hypot(c, a);
}

// The search begins with small cells. For each scatterer they are widened until no scatterer beyond
// the searched cells can have a closer image than the neighbours found.
std::vector<std::vector<Neighbour>> neighbours(const Placement& placement, std::size_t different) {
  std::vector<std::vector<Neighbour>> all(placement.size());
  std::vector<std::size_t> left;
  for (std::size_t j = 0; j < placement.size(); ++j) left.push_back(j);
  double largest_radius = 0;
  for (const auto& placed : placement)
    largest_radius = std::max(largest_radius, placed.scatterer.disk_radius());
  const Rectangle box = bounds_of(placement, &PlacedScatterer::position);
  double low = 0, high = 0;  // of y, relative to the first scatterer
  for (const auto& placed : placement) {
    const double y = placed.position.y - placement.front().position.y;
    low = std::min(low, y);
    high = std::max(high, y);
  }
  const double height = high - low, width = std::max({box.width(), box.depth(), height});
  const auto count = static_cast<double>(placement.size());
  const double spacing = width / (height > 0 ? std::cbrt(count) : std::sqrt(count));
  for (double cell = std::max({spacing, 2.5 * largest_radius, 1e-300}); !left.empty(); cell *= 2) {
    CellGrid grid(cell);
    for (std::size_t l = 0; l < placement.size(); ++l) grid.insert(placement[l].position, l);
    const bool last = cell > width;
    std::erase_if(left, [&](std::size_t j) {
      all[j] = found_in(grid, placement, j, different);
      const double radius = placement[j].scatterer.disk_radius();
      const double beyond = nearest_image(radius, largest_radius, cell);
      return last || (!all[j].empty() && all[j][0].image <= beyond);
    });
  }
  return all;
}

}  // namespace flatspeckle::wave
