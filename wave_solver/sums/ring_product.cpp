#include "wave_solver/sums/ring_product.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/sums/near_sum.h"
#include "wave_solver/sums/sum_cost.h"

namespace flatspeckle::wave {

namespace {

std::vector<Vec2> centres(const Placement& placement) {
  std::vector<Vec2> positions;
  for (const auto& placed : placement) positions.push_back(placed.position);
  return positions;
}

}  // namespace

RingProduct::RingProduct(const TMatrixSystem& system, double range, double tolerance) {
  blas_single_thread();
  const Placement& placement = system.placement();
  for (std::size_t j = 0; j <= placement.size(); ++j) first_.push_back(system.first(j));
  if (placement.empty()) return;
  make_rings(system, range, tolerance);
  std::optional<KernelSplit> split;
  if (std::isfinite(range)) {
    double largest = 0;
    for (const MultipoleRing& ring : rings_) largest = std::max(largest, ring.largest_charge);
    const double finer = grid_tolerance(tolerance, largest);
    resolved_ = finer >= finest_grid;
    if (!resolved_) return;
    split.emplace(system.k(), range, finer);
    const auto points = place_rings(placement, range);
    const GridShape shape(system.k(), range, finer, bounds(points, points));
    far_.emplace(*split, shape, finer, points, points);
  }
  find_neighbours(placement, range);
  parallel_for(placement.size(), [&](std::size_t j) {
    for (const Neighbour& neighbour : neighbours_[j])
      if (!neighbour.transposed) fill(system, j, neighbour, split);
  });
}

// One for each kind of scatterer and order.
void RingProduct::make_rings(const TMatrixSystem& system, double range, double tolerance) {
  using Key = std::tuple<int, double, double, double, double, double, int>;
  std::map<Key, std::uint32_t> known;
  for (std::size_t j = 0; j < system.placement().size(); ++j) {
    const Scatterer& s = system.placement()[j].scatterer;
    const Key key(static_cast<int>(s.kind), s.radius, s.index.real(), s.index.imag(), s.albedo,
                  s.phase_shift, system.order(j));
    const auto [kind, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(rings_.size()));
    if (is_new)
      rings_.emplace_back(system.modes(j), system.k(), s.disk_radius(), range + s.disk_radius(),
                          0.1 * tolerance);
    kind_.push_back(kind->second);
  }
}

// In an order in which neighbours stand close to each other.
std::vector<Vec2> RingProduct::place_rings(const Placement& placement, double range) {
  const auto positions = centres(placement);
  ring_first_.resize(placement.size());
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

void RingProduct::find_neighbours(const Placement& placement, double range) {
  const auto positions = centres(placement);
  double largest = 0, reach = 0;
  for (const MultipoleRing& ring : rings_) largest = std::max(largest, ring.radius);
  const Extent box = bounds(positions, positions);
  reach = std::min(range + 2 * largest, 2 * length(box.high - box.low) + 1);
  const StripOrder strips(positions, reach / 3);
  neighbours_.resize(placement.size());
  std::vector<StripOrder::Stretch> stretches;
  std::size_t size = 0;
  for (std::uint32_t j = 0; j < placement.size(); ++j) {
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

void RingProduct::fill(const TMatrixSystem& system, std::size_t row, const Neighbour& column,
                       const std::optional<KernelSplit>& split) {
  std::vector<std::size_t> rows(modes(row)), columns(modes(column.scatterer));
  std::iota(rows.begin(), rows.end(), first_[row]);
  std::iota(columns.begin(), columns.end(), first_[column.scatterer]);
  system.entries(rows, columns, &blocks_[column.block], rows.size());
  if (split) subtract_far(system.placement(), row, column, *split);
}

void RingProduct::subtract_far(const Placement& placement, std::size_t row, const Neighbour& column,
                               const KernelSplit& split) {
  const MultipoleRing &to = ring(row), &from = ring(column.scatterer);
  const Vec2 d = placement[row].position - placement[column.scatterer].position;
  std::vector<double> distance;
  for (std::size_t s = 0; s < from.points; ++s)
    for (std::size_t r = 0; r < to.points; ++r)
      distance.push_back(length(d + to.position(r) - from.position(s)));
  std::vector<Complex> far(distance.size());
  split.far(distance, far);
  const std::size_t rows = modes(row), columns = modes(column.scatterer);
  std::vector<Complex> received(to.points * columns);
  multiply(CblasNoTrans, CblasNoTrans, to.points, columns, from.points, 1, far.data(), to.points,
           from.charges.data(), from.points, 0, received.data(), to.points);
  multiply(CblasTrans, CblasNoTrans, rows, columns, to.points, -1, to.charges.data(), to.points,
           received.data(), to.points, 1, &blocks_[column.block], rows);
}

std::vector<Complex> RingProduct::operator()(std::span<const Complex> x) const {
  assert(resolved_);
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
               modes(near.scatterer), 1, &blocks_[near.block],
               near.transposed ? modes(near.scatterer) : modes(j), &x[first_[near.scatterer]],
               unknowns, 1, &y[first_[j]], unknowns);
    if (far_)
      multiply(CblasTrans, CblasNoTrans, modes(j), columns, ring(j).points, 1,
               ring(j).charges.data(), ring(j).points, &fields[ring_first_[j]], ring_points_, 1,
               &y[first_[j]], unknowns);
  });
  return y;
}

}  // namespace flatspeckle::wave
