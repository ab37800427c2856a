#include "wave_solver/sums/ring_product.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/contract.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/sums/near_sum.h"
#include "wave_solver/sums/sum_cost.h"

namespace flatspeckle::wave {

namespace {

using Bodies = std::span<const WaveEquations::Body>;

std::vector<Vec2> centres(Bodies bodies) {
  std::vector<Vec2> positions;
  for (const auto& body : bodies) positions.push_back(body.centre);
  return positions;
}

}  // namespace

RingProduct::RingProduct(const WaveEquations& system, double range, double tolerance) {
  blas_single_thread();
  const Bodies bodies = system.bodies();
  for (std::size_t j = 0; j <= bodies.size(); ++j) first_.push_back(system.first(j));
  if (bodies.empty()) return;
  make_rings(system, range, tolerance);
  std::optional<KernelSplit> split;
  if (std::isfinite(range)) {
    double largest = 0;
    for (const MultipoleRing& ring : rings_) largest = std::max(largest, ring.largest_charge);
    const double finer = grid_tolerance(tolerance, largest);
    resolved_ = finer >= finest_grid;
    if (!resolved_) return;
    split.emplace(system.k(), range, finer);
    const auto points = place_rings(bodies, range);
    const GridShape shape(system.k(), range, finer, bounds(points, points));
    far_.emplace(*split, shape, finer, points, points);
  }
  find_neighbours(bodies, range);
  parallel_for(bodies.size(), [&](std::size_t j) {
    for (const Neighbour& neighbour : neighbours_[j])
      if (!neighbour.transposed) fill(system, j, neighbour, split);
  });
}

// One for bodies of the same radius and waves.
void RingProduct::make_rings(const WaveEquations& system, double range, double tolerance) {
  std::map<std::vector<long double>, std::uint32_t> known;
  for (std::size_t j = 0; j < system.bodies().size(); ++j) {
    const double radius = system.bodies()[j].radius;
    std::vector<long double> key{radius};
    for (const Mode& mode : system.modes(j).modes)
      key.push_back(static_cast<long double>(mode.weight));
    const auto [kind, is_new] =
        known.try_emplace(std::move(key), static_cast<std::uint32_t>(rings_.size()));
    if (is_new)
      rings_.emplace_back(system.modes(j), system.k(), radius, range + radius, 0.1 * tolerance);
    kind_.push_back(kind->second);
  }
}

// In an order in which neighbours stand close to each other.
std::vector<Vec2> RingProduct::place_rings(std::span<const WaveEquations::Body> bodies,
                                           double range) {
  const auto positions = centres(bodies);
  ring_first_.resize(bodies.size());
  std::vector<Vec2> points;
  const StripOrder strips(positions, range / 3);
  for (const std::uint32_t j : strips.order()) {
    ring_first_[j] = points.size();
    for (std::size_t s = 0; s < ring(j).points; ++s)
      points.push_back(positions[j] + ring(j).position(s));
  }
  ring_points_ = points.size();
  return points;
}

void RingProduct::find_neighbours(std::span<const WaveEquations::Body> bodies, double range) {
  const auto positions = centres(bodies);
  double largest = 0, reach = 0;
  for (const MultipoleRing& ring : rings_) largest = std::max(largest, ring.radius);
  const Extent box = bounds(positions, positions);
  reach = std::min(range + 2 * largest, 2 * length(box.high - box.low) + 1);
  const StripOrder strips(positions, reach / 3);
  neighbours_.resize(bodies.size());
  std::vector<StripOrder::Stretch> stretches;
  std::size_t size = 0;
  for (std::uint32_t j = 0; j < bodies.size(); ++j) {
    stretches.clear();
    strips.around(positions[j], reach, stretches);
    for (const auto& stretch : stretches)
      for (const std::uint32_t l : strips.order().subspan(stretch.first, stretch.count)) {
        if (l < j) continue;
        if (length(positions[j] - positions[l]) >= range + ring(j).radius + ring(l).radius)
          continue;
        neighbours_[j].push_back({l, false, size});
        if (l != j) neighbours_[l].push_back({j, true, size});
        size += modes(j) * modes(l);
      }
  }
  blocks_.resize(size);
}

void RingProduct::fill(const WaveEquations& system, std::size_t row, const Neighbour& column,
                       const std::optional<KernelSplit>& split) {
  std::vector<std::size_t> rows(modes(row)), columns(modes(column.body));
  std::iota(rows.begin(), rows.end(), first_[row]);
  std::iota(columns.begin(), columns.end(), first_[column.body]);
  system.entries(rows, columns, &blocks_[column.block], rows.size());
  if (split) subtract_far(system.bodies(), row, column, *split);
}

void RingProduct::subtract_far(std::span<const WaveEquations::Body> bodies, std::size_t row,
                               const Neighbour& column, const KernelSplit& split) {
  const MultipoleRing &to = ring(row), &from = ring(column.body);
  const Vec2 d = bodies[row].centre - bodies[column.body].centre;
  std::vector<double> distance;
  for (std::size_t s = 0; s < from.points; ++s)
    for (std::size_t r = 0; r < to.points; ++r)
      distance.push_back(length(d + to.position(r) - from.position(s)));
  std::vector<Complex> far(distance.size());
  split.far(distance, far);
  const std::size_t rows = modes(row), columns = modes(column.body);
  std::vector<Complex> received(to.points * columns);
  multiply(CblasNoTrans, CblasNoTrans, to.points, columns, from.points, 1, far.data(), to.points,
           from.charges.data(), from.points, 0, received.data(), to.points);
  multiply(CblasTrans, CblasNoTrans, rows, columns, to.points, -1, to.charges.data(), to.points,
           received.data(), to.points, 1, &blocks_[column.block], rows);
}

std::vector<Complex> RingProduct::operator()(std::span<const Complex> x) const {
  FS_EXPECT(resolved_);
  const std::size_t unknowns = first_.back(), columns = unknowns ? x.size() / unknowns : 0;
  std::vector<Complex> charges(columns * ring_points_), fields(charges.size()), y(x.size());
  if (far_) {
    parallel_for(kind_.size(), [&](std::size_t j) {
      multiply(CblasNoTrans, CblasNoTrans, ring(j).points, columns, modes(j), 1,
               ring(j).charges.data(), ring(j).points, &x[first_[j]], unknowns, 0,
               &charges[ring_first_[j]], ring_points_);
    });
    far_->add(charges, fields);
  }
  parallel_for(kind_.size(), [&](std::size_t j) {
    for (const Neighbour& near : neighbours_[j])
      multiply(near.transposed ? CblasTrans : CblasNoTrans, CblasNoTrans, modes(j), columns,
               modes(near.body), 1, &blocks_[near.block],
               near.transposed ? modes(near.body) : modes(j), &x[first_[near.body]], unknowns, 1,
               &y[first_[j]], unknowns);
    if (far_)
      multiply(CblasTrans, CblasNoTrans, modes(j), columns, ring(j).points, 1,
               ring(j).charges.data(), ring(j).points, &fields[ring_first_[j]], ring_points_, 1,
               &y[first_[j]], unknowns);
  });
  return y;
}

}  // namespace flatspeckle::wave
