#include "wave_solver/maps/ring_field.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "core/numbers/hankel_array.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/sums/helmholtz_sum.h"

namespace flatspeckle::wave {

namespace {

// field[light][point] += factor sum over columns of values[column][point] x[light][column].
void add_columns(std::span<const Complex> values, std::size_t points, const Complex* x,
                 std::size_t ldx, double factor, std::span<Complex> field) {
  if (points == 0 || values.empty()) return;
  multiply(CblasNoTrans, CblasNoTrans, points, field.size() / points, values.size() / points,
           factor, values.data(), points, x, ldx, 1, field.data(), points);
}

const Complex* coefficients(const WaveSolution& solution, std::size_t scatterer) {
  return solution.coefficients(0).data() + solution.system().first(scatterer);
}

// Seconds for one ring of a kind, as measured: its sources in the sum, and the points to correct.
double cost(double ring_points, double modes, double near_points) {
  return 2e-6 * ring_points + near_points * (15e-9 * ring_points + 15e-9 * modes + 100e-9);
}

}  // namespace

void add_scattered(const WaveSolution& solution, std::size_t scatterer,
                   std::span<const Vec2> points, std::span<Complex> field) {
  const TMatrixSystem& system = solution.system();
  const ModeSet modes = system.modes(scatterer);
  std::vector<Complex> values(points.size() * modes.modes.size());
  field_at(system.k(), points, modes, {values.data(), points.size()});
  add_columns(values, points.size(), coefficients(solution, scatterer), system.unknowns(), 1,
              field);
}

RingField::RingField(const WaveSolution& solution, double tolerance, double area_per_point)
    : solution_(solution), tolerance_(tolerance) {
  blas_single_thread();
  std::vector<std::size_t> examples;
  find_kinds(examples);
  std::vector<std::optional<ClearedRing>> made(examples.size());
  parallel_for(examples.size(),
               [&](std::size_t kind) { made[kind] = best_ring(examples[kind], area_per_point); });
  for (auto& ring : made) {
    largest_charge_ = std::max(largest_charge_, ring->ring.largest_charge);
    rings_.push_back(std::move(*ring));
  }
  place_rings();
}

// Scatterers of equal make and order share a ring.
void RingField::find_kinds(std::vector<std::size_t>& examples) {
  const TMatrixSystem& system = solution_.system();
  const Placement& placement = system.placement();
  for (std::size_t j = 0; j < placement.size(); ++j) {
    const auto known = std::find_if(examples.begin(), examples.end(), [&](std::size_t example) {
      return placement[example].scatterer == placement[j].scatterer &&
             system.order(example) == system.order(j);
    });
    kind_.push_back(static_cast<std::uint32_t>(known - examples.begin()));
    if (known == examples.end()) examples.push_back(j);
  }
}

RingField::ClearedRing RingField::best_ring(std::size_t scatterer, double area_per_point) const {
  const TMatrixSystem& system = solution_.system();
  const ModeSet modes = system.modes(scatterer);
  const double radius = system.placement()[scatterer].scatterer.disk_radius();
  if (modes.order == 0) return {MultipoleRing(modes, system.k(), radius, radius, tolerance_), 0};
  std::optional<ClearedRing> best;
  double least = std::numeric_limits<double>::infinity();
  for (const double factor : {1.25, 1.5, 2.0, 3.0, 5.0, 8.0}) {
    const double clearance = factor * radius;
    MultipoleRing ring(modes, system.k(), radius, clearance, 0.1 * tolerance_);
    const double near = std::numbers::pi * (clearance - radius) * (clearance + radius);
    const double seconds = cost(static_cast<double>(ring.points),
                                static_cast<double>(modes.modes.size()), near / area_per_point);
    if (seconds >= least) continue;
    least = seconds;
    best = {std::move(ring), clearance};
  }
  return *best;
}

void RingField::place_rings() {
  const TMatrixSystem& system = solution_.system();
  const Placement& placement = system.placement();
  for (std::size_t j = 0; j < placement.size(); ++j) {
    first_.push_back(positions_.size());
    for (std::size_t s = 0; s < ring(j).ring.points; ++s)
      positions_.push_back(placement[j].position + ring(j).ring.position(s));
  }
  const std::size_t lights = solution_.light_angles().size();
  charges_.resize(lights * positions_.size());
  for (std::size_t j = 0; j < placement.size(); ++j) {
    const MultipoleRing& own = ring(j).ring;
    multiply(CblasNoTrans, CblasNoTrans, own.points, lights, system.modes(j).modes.size(), 1,
             own.charges.data(), own.points, coefficients(solution_, j), system.unknowns(), 0,
             &charges_[first_[j]], positions_.size());
  }
}

std::optional<std::vector<Complex>> RingField::sum(std::span<const Vec2> points) const {
  const double finer = std::max(tolerance_ / largest_charge_, smallest_tolerance);
  const HelmholtzSum sum(solution_.system().k(), positions_, points, finer);
  if (sum.range() == 0) return std::nullopt;
  return sum(charges_);
}

std::vector<Complex> RingField::correction(std::size_t scatterer,
                                           std::span<const Vec2> points) const {
  std::vector<Complex> field(solution_.light_angles().size() * points.size());
  add_scattered(solution_, scatterer, points, field);
  std::vector<double> distances;
  const std::size_t first = first_[scatterer], count = ring(scatterer).ring.points;
  for (std::size_t s = first; s < first + count; ++s)
    for (const Vec2 point : points)
      distances.push_back(solution_.system().k() * length(point - positions_[s]));
  std::vector<Complex> waves(distances.size());
  std::vector<std::size_t> coincident;
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (distances[i] == 0) coincident.push_back(i);
  for (const std::size_t i : coincident) distances[i] = 1;
  hankel0(distances, waves);
  for (const std::size_t i : coincident) waves[i] = 0;  // as in HelmholtzSum
  add_columns(waves, points.size(), &charges_[first], positions_.size(), -1, field);
  return field;
}

}  // namespace flatspeckle::wave
