#include "wave_solver/sums/sum_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace flatspeckle::wave {

namespace {

// Cells of the given side that the points fall into, in order.
std::vector<std::uint64_t> occupied(std::span<const Vec2> points, Vec2 low, double side) {
  std::vector<std::uint64_t> cells;
  cells.reserve(points.size());
  for (const Vec2 p : points)
    cells.push_back((static_cast<std::uint64_t>((p.x - low.x) / side) << 32) +
                    static_cast<std::uint64_t>((p.z - low.z) / side));
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace

Extent bounds(std::span<const Vec2> sources, std::span<const Vec2> targets) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Extent box{{infinity, infinity}, {-infinity, -infinity}};
  for (const auto points : {sources, targets})
    for (const Vec2 p : points) {
      box.low = {std::min(box.low.x, p.x), std::min(box.low.z, p.z)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.z, p.z)};
    }
  return box;
}

// Those in common cells of as large an area.
double near_pairs(std::span<const Vec2> sources, std::span<const Vec2> targets, double range) {
  const double side = range * std::sqrt(std::numbers::pi);
  const Vec2 low = bounds(sources, targets).low;
  const auto from = occupied(sources, low, side), to = occupied(targets, low, side);
  double pairs = 0;
  for (auto cell = to.begin(); cell != to.end();) {
    const auto next = std::upper_bound(cell, to.end(), *cell);
    const auto [first, last] = std::equal_range(from.begin(), from.end(), *cell);
    pairs += static_cast<double>(next - cell) * static_cast<double>(last - first);
    cell = next;
  }
  return pairs;
}

namespace cost {

namespace {
double limited(double bytes, double seconds) {
  return bytes > most_bytes ? std::numeric_limits<double>::infinity() : seconds;
}
}  // namespace

double grid(const GridShape& shape, double points) {
  const double cells = static_cast<double>(shape.x.size) * static_cast<double>(shape.z.size);
  const double lines = points * shape.width;
  return limited(
      12 * cells + 16 * lines,
      cells * 20e-9 + lines * 20e-9 + uses * (cells * 14e-9 + lines * shape.width * 0.5e-9));
}

double stored(double bytes, double seconds_to_make) {
  return limited(bytes, seconds_to_make + uses * bytes * 0.13e-9);
}

double all_pairs(double pairs) {
  return uses * pairs * 12e-9;
}

}  // namespace cost

}  // namespace flatspeckle::wave
