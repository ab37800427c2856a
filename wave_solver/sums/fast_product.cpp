#include "wave_solver/sums/fast_product.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "wave_solver/sums/helmholtz_sum.h"
#include "wave_solver/sums/ring_product.h"
#include "wave_solver/sums/sum_cost.h"

namespace flatspeckle::wave {

namespace {

std::vector<Vec2> positions(const WaveEquations& system) {
  std::vector<Vec2> result;
  for (const auto& body : system.bodies()) result.push_back(body.centre);
  return result;
}

// What the choice of a range looks at: the body of the highest order stands for all.
struct Outline {
  explicit Outline(const WaveEquations& system)
      : k(system.k()), centres(positions(system)), box(bounds(centres, centres)) {
    std::size_t highest = 0;
    for (std::size_t j = 0; j < centres.size(); ++j) {
      if (system.order(j) > system.order(highest)) highest = j;
      radius = std::max(radius, system.bodies()[j].radius);
    }
    modes = system.modes(highest);
    box = {box.low - Vec2{radius, radius}, box.high + Vec2{radius, radius}};
    squares = static_cast<double>(system.unknowns()) * static_cast<double>(system.unknowns());
  }

  double k;
  std::vector<Vec2> centres;
  Extent box;
  double radius = 0;
  ModeSet modes;
  double squares;  // elements of the matrix
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

// Cheapest range of a RingProduct; none where forming blocks at every use is cheaper.
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
  const double extent =
      std::max(outline.box.high.x - outline.box.low.x, outline.box.high.z - outline.box.low.z);
  for (double r = extent / 3; r > extent * 1e-3; r /= std::numbers::sqrt2)
    consider(r, grid_cost(outline, r, tolerance));
  return range;
}

bool points_only(const WaveEquations& system) {
  return system.unknowns() == system.bodies().size();
}

}  // namespace

FastProduct::FastProduct(const WaveEquations& system, double tolerance) : system_(system) {
  if (system.unknowns() == 0) return;
  if (points_only(system)) {
    points_ = std::make_unique<HelmholtzSum>(system.k(), positions(system), tolerance);
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
