#include "wave_solver/sums/fast_product.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/contract.h"
#include "core/numbers/bessel.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/sums/helmholtz_sum.h"

namespace flatspeckle::wave {

namespace {

constexpr long double infinity = std::numeric_limits<long double>::infinity();

// Returns, for n = 0 .. order, the size sqrt(2) weight / |J_n(k rho)| of the charges on a ring of
// radius rho (MultipoleRing). Charges are moderate unless rho is close to an interior resonance,
// J_n(k rho) = 0.
std::vector<long double> amplitudes(const ModeSet& modes, double k, double rho) {
  const auto j = bessel_j(modes.order, k * rho);
  std::vector<long double> result(modes.order + 1, 0);
  for (const Mode& mode : modes.modes) {
    const long double size = std::abs(j[mode.order]);
    result[mode.order] =
        size > 0 ? 2 * root_half * static_cast<long double>(mode.weight) / size : infinity;
  }
  return result;
}

// Returns the ring radius with the smallest charges; 0 if charges overflow on every circle.
double best_radius(const ModeSet& modes, double k, double disk) {
  constexpr int tries = 32;
  double best = 0;
  long double least = infinity;
  for (int i = 0; i < tries; ++i) {
    const double rho = disk * (1 - 0.5 * i / tries);
    const auto found = amplitudes(modes, k, rho);
    const long double largest = *std::max_element(found.begin(), found.end());
    if (largest < least) {
      least = largest;
      best = rho;
    }
  }
  return best;
}

// Returns the smallest number Q of ring points with which, for every order n, the spurious wave of
// order Q - n (MultipoleRing) is negligible at the distance; 0 if the estimate overflows.
std::size_t enough_points(const ModeSet& modes, double k, double rho, double distance,
                          double tolerance) {
  const auto strength = amplitudes(modes, k, rho);
  for (int last = 2 * modes.order + 64;; last *= 2) {
    const auto j = bessel_j(last, k * rho);
    const auto h = hankel(last, k * distance);
    for (int q = 2 * modes.order + 2; q <= last; q += 2) {
      long double worst = 0;
      for (int n = 0; n <= modes.order; ++n) {
        const long double alias = strength[n] * std::abs(j[q - n]) * std::abs(h[q - n]);
        if (!std::isfinite(alias)) return 0;
        worst = std::max(worst, alias);
      }
      if (worst < tolerance) return q;
    }
  }
}

using Bodies = std::span<const WaveEquations::Body>;

std::vector<Vec> centres(Bodies bodies) {
  std::vector<Vec> positions;
  for (const auto& body : bodies) positions.push_back(body.centre);
  return positions;
}

// Properties of a system from which the range of its RingProduct is chosen. The body with the
// highest order represents all bodies.
struct Outline {
  explicit Outline(const WaveEquations& system)
      : k(system.k()), centres(wave::centres(system.bodies())), box(bounds_of_all(centres)) {
    std::size_t highest = 0;
    for (std::size_t j = 0; j < centres.size(); ++j) {
      if (system.order(j) > system.order(highest)) highest = j;
      radius = std::max(radius, system.bodies()[j].radius);
    }
    modes = system.modes(highest);
    box = {box.low - Vec{radius, radius}, box.high + Vec{radius, radius}};
    squares = static_cast<double>(system.unknowns()) * static_cast<double>(system.unknowns());
  }

  double k;
  std::vector<Vec> centres;
  PointBounds box;
  double radius = 0;
  ModeSet modes;
  double squares;  // number of elements of M
};

constexpr double seconds_per_element = 30e-9, seconds_per_distance = 40e-9;

double grid_cost(const Outline& outline, double range, double tolerance) {
  const MultipoleRing ring(outline.modes, outline.k, outline.radius, range + outline.radius,
                           tolerance);
  const double finer = RingProduct::grid_tolerance(tolerance, ring.largest_charge);
  if (finer < RingProduct::finest_grid) return std::numeric_limits<double>::infinity();
  const auto count = static_cast<double>(outline.centres.size());
  const auto points = static_cast<double>(ring.points);
  const double reach = range + 2 * outline.radius;
  const double pairs = near_pairs(outline.centres, outline.centres, reach) / 2;
  const double block = outline.squares / (count * count);
  return cost::grid(GridShape(outline.k, range, finer, outline.box), 2 * points * count) +
         cost::stored(16 * pairs * block, pairs * (points * points * seconds_per_distance +
                                                   block * seconds_per_element));
}

// Returns the cheapest range of a RingProduct; nullopt if it is cheaper to compute the blocks of M
// anew for every product.
std::optional<double> best_range(const WaveEquations& system, double tolerance, bool with_grid) {
  const Outline outline(system);
  double best = cost::uses * outline.squares * seconds_per_element;
  std::optional<double> range;
  const auto consider = [&](double r, double cost) {
    if (cost >= best) return;
    best = cost;
    range = r;
  };
  consider(std::numeric_limits<double>::infinity(),
           cost::stored(8 * outline.squares, outline.squares / 2 * seconds_per_element));
  if (!with_grid) return range;
  const double extent = outline.box.extent();
  for (double r = extent / 3; r > extent * 1e-3; r /= std::numbers::sqrt2)
    consider(r, grid_cost(outline, r, tolerance));
  return range;
}

bool points_only(const WaveEquations& system) {
  return system.unknowns() == system.bodies().size();
}

/// Returns, for each mode, the sum of the charges on a ring with k rho = size, without the angular
/// factor of the charges.
std::vector<double> summed_charges(const ModeSet& modes, double size) {
  const auto j = size > 0 ? bessel_j(modes.order, size) : std::vector<long double>{1};
  std::vector<double> all;
  for (const Mode& mode : modes.modes)
    all.push_back(
        static_cast<double>(2 * root_half * static_cast<long double>(mode.weight) / j[mode.order]));
  return all;
}

}  // namespace

MultipoleRing::MultipoleRing(const ModeSet& modes, double k, double disk, double distance,
                             double tolerance) {
  if (modes.order > 0) {
    if (std::isfinite(distance)) radius = best_radius(modes, k, disk);
    points = radius > 0 ? enough_points(modes, k, radius, distance, tolerance) : 0;
    if (points == 0) {
      largest_charge = std::numeric_limits<double>::infinity();
      return;
    }
  }
  for (const double charge : summed_charges(modes, k * radius))
    largest_charge = std::max(largest_charge, std::abs(charge));
}

void MultipoleRing::charge(const ModeSet& modes, double k) {
  if (points == 0) return;
  charges.resize(modes.modes.size() * points);
  const auto summed = summed_charges(modes, k * radius);
  for (std::size_t m = 0; m < modes.modes.size(); ++m) {
    const Mode& mode = modes.modes[m];
    const double each = summed[m] / static_cast<double>(points);
    for (std::size_t s = 0; s < points; ++s) {
      const double angle =
          mode.order * 2 * std::numbers::pi * static_cast<double>(s) / static_cast<double>(points);
      charges[m * points + s] = each * (mode.odd ? std::sin(angle) : std::cos(angle));
    }
  }
}

Vec MultipoleRing::position(std::size_t point) const {
  return radius *
         direction(2 * std::numbers::pi * static_cast<double>(point) / static_cast<double>(points));
}

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
    const GridShape shape(system.k(), range, finer, bounds_of_all(points));
    far_.emplace(*split, shape, finer, points, points);
  }
  find_neighbours(bodies, range);
  parallel_for(bodies.size(), [&](std::size_t j) {
    for (const Neighbour& neighbour : neighbours_[j])
      if (!neighbour.transposed) fill(system, j, neighbour, split);
  });
}

// Makes one MultipoleRing for all bodies with the same radius and the same modes.
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
      rings_.emplace_back(system.modes(j), system.k(), radius, range + radius, 0.1 * tolerance)
          .charge(system.modes(j), system.k());
    kind_.push_back(kind->second);
  }
}

// Returns the positions of all ring points, in an order in which points close in space are close in
// the list.
std::vector<Vec> RingProduct::place_rings(std::span<const WaveEquations::Body> bodies,
                                          double range) {
  const auto positions = centres(bodies);
  ring_first_.resize(bodies.size());
  std::vector<Vec> points;
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
  const PointBounds box = bounds_of_all(positions);
  reach = std::min(range + 2 * largest, 2 * length(box.high - box.low) + 1);
  const StripOrder strips(positions, reach / 3);
  neighbours_.resize(bodies.size());
  std::vector<StripOrder::Interval> intervals;
  std::size_t size = 0;
  for (std::uint32_t j = 0; j < bodies.size(); ++j) {
    intervals.clear();
    strips.around(positions[j], reach, intervals);
    for (const auto& interval : intervals)
      for (const std::uint32_t l : strips.order().subspan(interval.first, interval.count)) {
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
  const Vec d = bodies[row].centre - bodies[column.body].centre;
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

FastProduct::FastProduct(const WaveEquations& system, double tolerance) : system_(system) {
  if (system.unknowns() == 0) return;
  if (points_only(system)) {
    points_ = std::make_unique<HelmholtzSum>(system.k(), centres(system.bodies()), tolerance);
    for (std::size_t j = 0; j < system.unknowns(); ++j)
      sigma_.push_back(std::sqrt(system.strength(j)));
    return;
  }
  for (const bool with_grid : {true, false}) {
    const auto range = best_range(system, tolerance, with_grid);
    rings_ = range ? std::make_unique<RingProduct>(system, *range, tolerance) : nullptr;
    if (!rings_ || rings_->resolved()) return;
  }
}

FastProduct::~FastProduct() = default;

std::vector<Complex> FastProduct::operator()(std::span<const Complex> x) const {
  if (points_) return sum_over_points(x);
  return rings_ ? (*rings_)(x) : system_.apply(x);
}

std::vector<Complex> FastProduct::sum_over_points(std::span<const Complex> x) const {
  const std::size_t size = sigma_.size();
  std::vector<Complex> charges(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) charges[i] = sigma_[i % size] * x[i];
  auto y = (*points_)(charges);
  for (std::size_t i = 0; i < x.size(); ++i)
    y[i] = sigma_[i % size] * y[i] + system_.diagonal(i % size) * x[i];
  return y;
}

}  // namespace flatspeckle::wave
