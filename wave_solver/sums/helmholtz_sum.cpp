#include "wave_solver/sums/helmholtz_sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "core/numbers/hankel_array.h"
#include "core/run/parallel.h"

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

// The cheapest radius of the near part, or 0 where summing all pairs is cheaper.
double best_range(double k, double tolerance, std::span<const Vec2> sources,
                  std::span<const Vec2> targets) {
  const Rectangle box = bounds_of(sources).joined(bounds_of(targets));
  const double extent = std::max(box.width(), box.depth());
  const auto from = static_cast<double>(sources.size()), to = static_cast<double>(targets.size());
  double best = cost::all_pairs(from * to), range = 0;
  for (double r = extent / 3; r > extent * 1e-4; r /= std::numbers::sqrt2) {
    const double grid = cost::grid(GridShape(k, r, tolerance, box), from + to);
    if (grid > best) continue;
    const double pairs = near_pairs(sources, targets, r);
    const double cost = grid + cost::stored(1.3 * 8 * pairs, 40e-9 * pairs);
    if (cost < best) {
      best = cost;
      range = r;
    }
  }
  return range;
}

std::vector<Vec2> in_order(std::span<const Vec2> points, std::span<const std::uint32_t> order) {
  std::vector<Vec2> result;
  result.reserve(points.size());
  for (const std::uint32_t i : order) result.push_back(points[i]);
  return result;
}

}  // namespace

// Those in common cells of as large an area.
double near_pairs(std::span<const Vec2> sources, std::span<const Vec2> targets, double range) {
  const double side = range * std::sqrt(std::numbers::pi);
  const Vec2 low = bounds_of(sources).joined(bounds_of(targets)).low;
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

HelmholtzSum::HelmholtzSum(double k, std::span<const Vec2> points, double tolerance)
    : HelmholtzSum(k, points, points, tolerance) {}

HelmholtzSum::HelmholtzSum(double k, std::span<const Vec2> sources, std::span<const Vec2> targets,
                           double tolerance)
    : k_(k), sources_(sources.begin(), sources.end()), targets_(targets.begin(), targets.end()) {
  if (sources.empty() || targets.empty()) return;
  range_ = best_range(k, tolerance, sources, targets);
  if (range_ == 0) return;
  const StripOrder by_source(sources, range_ / 3), by_target(targets, range_ / 3);
  source_order_.assign(by_source.order().begin(), by_source.order().end());
  target_order_.assign(by_target.order().begin(), by_target.order().end());
  sources_ = in_order(sources, source_order_);
  targets_ = in_order(targets, target_order_);
  const KernelSplit split(k, range_, tolerance);
  const GridShape shape(k, range_, tolerance, bounds_of(sources).joined(bounds_of(targets)));
  near_.emplace(split, by_source, sources, targets_);
  far_.emplace(split, shape, tolerance, sources_, targets_);
}

std::vector<Complex> HelmholtzSum::operator()(std::span<const Complex> charges) const {
  if (sources_.empty() || targets_.empty()) return {};
  if (range_ == 0) return all_pairs(charges);
  const std::size_t from = sources_.size(), to = targets_.size(), columns = charges.size() / from;
  std::vector<Complex> ordered(charges.size()), sums(columns * to), result(columns * to);
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t i = 0; i < from; ++i)
      ordered[c * from + i] = charges[c * from + source_order_[i]];
  far_->add(ordered, sums);
  near_->add(ordered, sums);
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t i = 0; i < to; ++i) result[c * to + target_order_[i]] = sums[c * to + i];
  return result;
}

std::vector<Complex> HelmholtzSum::all_pairs(std::span<const Complex> charges) const {
  const std::size_t from = sources_.size(), to = targets_.size(), columns = charges.size() / from;
  std::vector<Complex> sums(columns * to);
  parallel_for(to, [&](std::size_t i) {
    std::vector<double> x(from);
    std::vector<Complex> h(from);
    std::vector<std::size_t> coincident;
    for (std::size_t j = 0; j < from; ++j) {
      x[j] = k_ * length(sources_[j] - targets_[i]);
      if (x[j] == 0) coincident.push_back(j);
      if (x[j] == 0) x[j] = 1;
    }
    hankel0(x, h);
    for (const std::size_t j : coincident) h[j] = 0;
    for (std::size_t c = 0; c < columns; ++c) {
      Complex sum = 0;
      for (std::size_t j = 0; j < from; ++j) sum += product(h[j], charges[c * from + j]);
      sums[c * to + i] = sum;
    }
  });
  return sums;
}

}  // namespace flatspeckle::wave
