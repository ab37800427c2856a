#include "wave_solver/sums/helmholtz_sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "core/run/parallel.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

StripOrder::StripOrder(std::span<const Vec> points, double height)
    : height_(height), order_(points.size()), first_{0}, z_(points.size()) {
  if (points.empty()) return;
  const PointBounds box = bounds_of_all(points);
  low_ = box.low;
  levels_ = static_cast<std::size_t>((box.high.y - low_.y) / height_) + 1;
  std::vector<std::size_t> strip(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    strip[i] = static_cast<std::size_t>((points[i].x - low_.x) / height_) * levels_ +
               static_cast<std::size_t>((points[i].y - low_.y) / height_);
  std::iota(order_.begin(), order_.end(), 0U);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (strip[a] != strip[b]) return strip[a] < strip[b];
    return points[a].z != points[b].z ? points[a].z < points[b].z : a < b;
  });
  first_.assign(strip[order_.back()] + 2, 0);
  for (const std::size_t s : strip) ++first_[s + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  for (std::size_t i = 0; i < order_.size(); ++i) z_[i] = points[order_[i]].z;
}

void StripOrder::around(Vec place, double distance, std::vector<Interval>& intervals) const {
  const double reach = distance / height_;
  // Numbers of the strips along one axis that are within reach of a coordinate, in units of
  // height_.
  const auto within = [&](double own, std::size_t count) {
    const auto most = static_cast<double>(count);
    return std::pair(static_cast<std::size_t>(std::clamp(std::floor(own - reach), 0.0, most)),
                     static_cast<std::size_t>(std::clamp(std::floor(own + reach) + 1, 0.0, most)));
  };
  const auto distance_of = [&](std::size_t strip, double own) {
    const auto s = static_cast<double>(strip);
    return height_ * std::max({s - own, own - s - 1, 0.0});
  };
  const double x = (place.x - low_.x) / height_, y = (place.y - low_.y) / height_;
  const auto [from, to] = within(x, (first_.size() - 2) / levels_ + 1);
  const auto [from_level, to_level] = within(y, levels_);
  for (std::size_t row = from; row < to; ++row)
    for (std::size_t level = from_level; level < to_level; ++level) {
      const std::size_t s = row * levels_ + level;
      if (s + 1 >= first_.size()) break;
      const double beside = distance_of(row, x), above = distance_of(level, y);
      // Half the length of the strip within the circle around `place`, slightly enlarged so that
      // rounding loses no pair.
      const double chord =
          std::sqrt(std::max(distance * distance - beside * beside - above * above, 0.0)) +
          1e-6 * distance;
      const auto begin = z_.begin() + first_[s], end = z_.begin() + first_[s + 1];
      const auto low = std::lower_bound(begin, end, place.z - chord);
      const auto high = std::upper_bound(low, end, place.z + chord);
      if (low < high)
        intervals.push_back(
            {static_cast<std::uint32_t>(low - z_.begin()), static_cast<std::uint32_t>(high - low)});
    }
}

NearSum::NearSum(const KernelSplit& split, const StripOrder& strips, std::span<const Vec> sources,
                 std::span<const Vec> targets)
    : sources_(sources.size()), targets_(targets.size()) {
  constexpr std::size_t block_size = 256;
  for (std::size_t first = 0; first < targets_; first += block_size)
    blocks_.emplace_back(first, std::min(block_size, targets_ - first));
  parallel_for(blocks_.size(),
               [&](std::size_t b) { fill(blocks_[b], split, strips, sources, targets); });
}

void NearSum::fill(Block& block, const KernelSplit& split, const StripOrder& strips,
                   std::span<const Vec> sources, std::span<const Vec> targets) const {
  std::vector<double> distance;
  for (std::size_t i = block.first; i < block.first + block.count; ++i) {
    const std::size_t before = block.sources.size();
    strips.around(targets[i], split.range(), block.sources);
    block.interval_counts.push_back(static_cast<std::uint32_t>(block.sources.size() - before));
    for (std::size_t s = before; s < block.sources.size(); ++s)
      for (std::uint32_t n = 0; n < block.sources[s].count; ++n) {
        const std::uint32_t j = block.sources[s].first + n;
        distance.push_back(length(sources[strips.order()[j]] - targets[i]));
        if (distance.back() == 0) block.coincident.emplace_back(static_cast<std::uint32_t>(i), j);
      }
  }
  block.values.resize(distance.size());
  split.near(distance, block.values);
}

void NearSum::add(std::span<const Complex> charges, std::span<Complex> sums) const {
  if (sources_ == 0) return;
  const std::size_t columns = charges.size() / sources_;
  std::vector<double> re(charges.size()), im(charges.size());
  for (std::size_t i = 0; i < charges.size(); ++i) {
    re[i] = charges[i].real();
    im[i] = charges[i].imag();
  }
  parallel_for(blocks_.size(), targets_ * columns > 10000, [&](std::size_t b) {
    const Block& block = blocks_[b];
    for (std::size_t column = 0; column < columns; ++column) {
      const double* q_re = &re[column * sources_];
      const double* q_im = &im[column * sources_];
      const double* value = block.values.data();
      auto interval = block.sources.begin();
      for (std::size_t i = 0; i < block.count; ++i) {
        double sum_re = 0, sum_im = 0;
        for (std::uint32_t s = 0; s < block.interval_counts[i]; ++s, ++interval) {
#pragma omp simd reduction(+ : sum_re, sum_im)
          for (std::uint32_t n = 0; n < interval->count; ++n) {
            sum_re += value[n] * q_re[interval->first + n];
            sum_im += value[n] * q_im[interval->first + n];
          }
          value += interval->count;
        }
        sums[column * targets_ + block.first + i] += Complex(-sum_im, sum_re);
      }
      for (const auto& [i, j] : block.coincident)
        sums[column * targets_ + i] -= charges[column * sources_ + j];
    }
  });
}

namespace {

// Returns, sorted, the cell of each point in a grid of square or cubic cells with the given side.
std::vector<std::uint64_t> occupied(std::span<const Vec> points, Vec low, double side) {
  std::vector<std::uint64_t> cells;
  cells.reserve(points.size());
  for (const Vec p : points)
    cells.push_back((static_cast<std::uint64_t>((p.x - low.x) / side) << 42) +
                    (static_cast<std::uint64_t>((p.y - low.y) / side) << 21) +
                    static_cast<std::uint64_t>((p.z - low.z) / side));
  std::sort(cells.begin(), cells.end());
  return cells;
}

// Returns the cheapest range of the KernelSplit, or 0 if it is cheaper to sum all pairs directly.
double best_range(double k, double tolerance, std::span<const Vec> sources,
                  std::span<const Vec> targets, Radial kind) {
  const PointBounds box = bounds_of_all(sources, targets);
  const double extent = box.extent(), stored = kind == Radial::cylindrical ? 1.3 : 1.7;
  const auto from = static_cast<double>(sources.size()), to = static_cast<double>(targets.size());
  double best = cost::all_pairs(from * to, kind), range = 0;
  for (double r = extent / 3; r > extent * 1e-4; r /= std::numbers::sqrt2) {
    const double grid = cost::grid(GridShape(k, r, tolerance, box, kind), from + to);
    if (grid > best) continue;
    const double pairs = near_pairs(sources, targets, r, kind);
    const double cost = grid + cost::stored(stored * 8 * pairs, 40e-9 * pairs);
    if (cost < best) {
      best = cost;
      range = r;
    }
  }
  return range;
}

std::vector<Vec> in_order(std::span<const Vec> points, std::span<const std::uint32_t> order) {
  std::vector<Vec> result;
  result.reserve(points.size());
  for (const std::uint32_t i : order) result.push_back(points[i]);
  return result;
}

}  // namespace

// Counts the pairs whose two points are in the same cell of a grid. The cells have the area of a
// disk of radius `range`, in space the volume of a ball.
double near_pairs(std::span<const Vec> sources, std::span<const Vec> targets, double range,
                  Radial kind) {
  const double side = range * (kind == Radial::cylindrical ? std::sqrt(std::numbers::pi)
                                                           : std::cbrt(4 * std::numbers::pi / 3));
  const Vec low = bounds_of_all(sources, targets).low;
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
  const bool fits = bytes < std::min(most_bytes, memory_of_system());
  return fits ? seconds : std::numeric_limits<double>::infinity();
}
}  // namespace

double grid(const GridShape& shape, double points) {
  const double cells = shape.points(), lines = points * shape.width;
  const double each = shape.levels() > 1 ? 28e-9 : 14e-9;
  return limited(12 * cells + 24 * lines,
                 cells * 20e-9 + lines * 20e-9 +
                     uses * (cells * each + lines * shape.width * shape.levels() * 0.5e-9));
}

double stored(double bytes, double seconds_to_make) {
  return limited(bytes, seconds_to_make + uses * bytes * 0.13e-9);
}

double all_pairs(double pairs, Radial kind) {
  return uses * pairs * (kind == Radial::cylindrical ? 12e-9 : 1.4e-9);
}

}  // namespace cost

HelmholtzSum::HelmholtzSum(double k, std::span<const Vec> sources, std::span<const Vec> targets,
                           double tolerance, Radial kind)
    : k_(k),
      kind_(kind),
      sources_(sources.begin(), sources.end()),
      targets_(targets.begin(), targets.end()) {
  if (sources.empty() || targets.empty()) return;
  range_ = best_range(k, tolerance, sources, targets, kind);
  if (range_ > 0) split_sums(tolerance);
}

HelmholtzSum::HelmholtzSum(double k, std::span<const Vec> points, double tolerance, Radial kind,
                           double range)
    : k_(k),
      range_(range),
      kind_(kind),
      sources_(points.begin(), points.end()),
      targets_(sources_) {
  if (range_ > 0 && !points.empty()) split_sums(tolerance);
}

// Makes the near and the far part, and sorts sources and targets.
void HelmholtzSum::split_sums(double tolerance) {
  const std::vector<Vec> sources = std::move(sources_), targets = std::move(targets_);
  const StripOrder by_source(sources, range_ / 3), by_target(targets, range_ / 3);
  source_order_.assign(by_source.order().begin(), by_source.order().end());
  target_order_.assign(by_target.order().begin(), by_target.order().end());
  sources_ = in_order(sources, source_order_);
  targets_ = in_order(targets, target_order_);
  const KernelSplit split(k_, range_, tolerance, kind_);
  const GridShape shape(k_, range_, tolerance, bounds_of_all(sources, targets), kind_);
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
    outgoing_wave(kind_, x, h);
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
