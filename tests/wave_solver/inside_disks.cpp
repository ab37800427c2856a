#include "inside_disks.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "multipole_oracle.h"
#include "wave_solver/equations/rim_waves.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/maps/field_map.h"

namespace flatspeckle::wave {

namespace {

constexpr double light = 0.3;

double between(RandomStream& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

/// Draws a disk whose radius is within a factor 2 of a size.
Scatterer random_disk(double size, RandomStream& random) {
  using Kind = Scatterer::Kind;
  constexpr Kind kinds[] = {Kind::tm, Kind::tm, Kind::te, Kind::te, Kind::soft, Kind::hard};
  Scatterer disk;
  disk.kind = kinds[static_cast<int>(6 * random.uniform())];
  disk.radius = between(random, size / 2, 2 * size);
  if (disk.is_penetrable()) disk.index = between(random, 1.05, 8);
  return disk;
}

constexpr double least_gap = 1e-4;  // of the smaller radius

/// Draws a cluster in which the gap between each disk and an earlier one is at most the smaller
/// radius.
Placement random_cluster(int number, int most_disks) {
  RandomStream random(11, 95, number);
  const auto count = 2 + static_cast<std::size_t>((most_disks - 1) * random.uniform());
  const double size = between(random, 0.01, 0.2);
  Placement placement{{{0.1, -0.2}, random_disk(size, random)}};
  while (placement.size() < count) {
    const Scatterer disk = random_disk(size, random);
    const auto& by = placement[static_cast<std::size_t>(random.uniform() *
                                                        static_cast<double>(placement.size()))];
    const double smaller = std::min(disk.radius, by.scatterer.radius);
    const double away = disk.radius + by.scatterer.radius + between(random, least_gap, 1) * smaller;
    const Vec at = by.position + away * direction(two_pi * random.uniform());
    const bool is_free = std::all_of(placement.begin(), placement.end(), [&](const auto& other) {
      const double gap = length(at - other.position) - disk.radius - other.scatterer.radius;
      return gap > 0.99 * least_gap * std::min(disk.radius, other.scatterer.radius);
    });
    if (is_free) placement.push_back({at, disk});
  }
  return placement;
}

/// Returns the sensors of a map that contains all disks.
std::vector<Vec> sensors(const Placement& placement) {
  return map_sensors({{-50, -50}, {50, 50}, 1, 1}, placement);
}

WaveSolution solved(const Placement& placement, double tolerance) {
  return solve(placement, two_pi, {light},
               {.tolerance = tolerance, .sensors = sensors(placement), .diagnose = false});
}

/// Whether the most accurate solution is small enough; some disks are too close to be solved at
/// all.
bool is_small(const Placement& placement, std::size_t most_unknowns) {
  try {
    return TMatrixSystem(placement, two_pi, 1e-12, sensors(placement)).unknowns() <= most_unknowns;
  } catch (const InputError&) {
    return false;
  }
}

/// Returns an oracle for a solution, with orders that are certainly sufficient.
MultipoleOracle oracle_of(const WaveSolution& solution) {
  std::vector<int> orders = solution.basis_order();
  for (int& order : orders) order += order / 4 + 4;
  return {solution.system().placement(), two_pi, solution.light_angles()[0], orders};
}

Complex inside(const WaveSolution& solution, std::size_t disk, Vec point) {
  const ModeSet modes = solution.system().modes(disk);
  std::vector<Complex> waves(modes.modes.size());
  field_inside(solution.system(), disk, {&point, 1}, {waves.data(), 1});
  const auto beta = solution.coefficients(0).subspan(solution.system().first(disk));
  Complex sum = 0;
  for (std::size_t n = 0; n < waves.size(); ++n) sum += beta[n] * waves[n];
  return sum;
}

Complex outside(const WaveSolution& solution, Vec point) {
  return solution.near_field(point, 0) + std::polar(1.0, two_pi * dot(direction(light), point));
}

/// Two points at a rim, slightly inside and outside.
struct RimPoint {
  std::size_t disk;
  Vec within, beyond;
};
std::vector<RimPoint> rim_points(const Placement& placement) {
  constexpr int count = 24;
  constexpr double little = 1e-9;
  std::vector<RimPoint> points;
  for (std::size_t disk = 0; disk < placement.size(); ++disk)
    for (int i = 0; i < count; ++i) {
      const auto& [centre, scatterer] = placement[disk];
      const Vec to = scatterer.radius * direction(two_pi * i / count);
      points.push_back({disk, centre + (1 - little) * to, centre + (1 + little) * to});
    }
  return points;
}

/// Returns points on both rims at the gap between two disks, and near it.
std::vector<RimPoint> gap_points(const Placement& two) {
  constexpr double little = 1e-9;
  std::vector<RimPoint> points;
  for (const std::size_t disk : {0, 1}) {
    const auto& [centre, scatterer] = two[disk];
    const Vec across = two[1 - disk].position - centre;
    const double gap = length(across) - two[0].scatterer.radius - two[1].scatterer.radius;
    for (const double widths : {-1.0, 0.0, 0.5, 2.0}) {
      const double turn = widths * std::sqrt(2 * gap / scatterer.radius);
      const Vec to = scatterer.radius * direction(angle_of(across) + turn);
      points.push_back({disk, centre + (1 - little) * to, centre + (1 + little) * to});
    }
  }
  return points;
}

/// Returns errors relative to the largest field at any of the points.
WorstError error_of(const WaveSolution& solution, const MultipoleOracle& oracle,
                    const std::vector<RimPoint>& points) {
  double largest = 1;
  WorstError off;
  for (const auto& [disk, within, beyond] : points) {
    const Complex exact = oracle.outside(beyond);
    largest = std::max(largest, std::abs(exact));
    off.outside = std::max(off.outside, std::abs(outside(solution, beyond) - exact));
    if (solution.system().placement()[disk].scatterer.is_penetrable())
      off.inside = std::max(off.inside,
                            std::abs(inside(solution, disk, within) - oracle.inside(disk, within)));
  }
  return {off.inside / largest, off.outside / largest};
}

void add_errors(const Placement& placement, const std::vector<RimPoint>& points,
                const std::vector<double>& tolerances, std::vector<WorstError>& worst) {
  const MultipoleOracle oracle = oracle_of(solved(placement, 1e-12));
  for (std::size_t i = 0; i < tolerances.size(); ++i)
    worst[i].add(error_of(solved(placement, tolerances[i]), oracle, points), tolerances[i]);
}

}  // namespace

std::vector<WorstError> worst_errors(int first, int clusters, const ClusterSize& most,
                                     const std::vector<double>& tolerances) {
  std::vector<WorstError> worst(tolerances.size());
  for (int number = first; clusters > 0; ++number) {
    const Placement placement = random_cluster(number, most.disks);
    if (!is_small(placement, most.unknowns)) continue;
    --clusters;
    add_errors(placement, rim_points(placement), tolerances, worst);
  }
  return worst;
}

void check_gap(const std::string& kind, double ratio, double gap,
               const std::vector<double>& tolerances) {
  Scatterer disk = reference_scatterer(kind);
  disk.radius = 1 / two_pi;
  Scatterer other = disk;
  other.radius *= ratio;
  const double away = disk.radius + other.radius * (1 + gap);
  const Placement two{{{0.1, -0.2}, disk}, {Vec{0.1, -0.2} + away * direction(1.2), other}};
  std::vector<WorstError> worst(tolerances.size());
  add_errors(two, gap_points(two), tolerances, worst);
  CAPTURE(ratio);
  CAPTURE(gap);
  for (const WorstError& error : worst) {
    CHECK(error.inside < 1);
    CHECK(error.outside < 1);
  }
}

double worst_on_map(const Placement& placement, double angle, const MapGrid& grid, double tolerance,
                    std::size_t stride) {
  SolveOptions options{.tolerance = tolerance, .sensors = {}, .diagnose = false};
  options.sensors = map_sensors(grid, placement);
  const auto solution = solve(placement, two_pi, {angle}, options);
  const MultipoleOracle oracle = oracle_of(solution);
  const MapTile all{0, 0, grid.nx, grid.nz};
  const auto field = FieldMap(solution, grid, tolerance).field(all);
  double worst = 0;
  for (std::size_t pixel = 0; pixel < all.pixels(); pixel += stride) {
    const Vec point = grid.pixel(pixel % grid.nx, pixel / grid.nx);
    const auto around = std::find_if(placement.begin(), placement.end(), [&](const auto& placed) {
      return length(point - placed.position) < placed.scatterer.radius;
    });
    const auto disk = static_cast<std::size_t>(around - placement.begin());
    const Complex exact =
        around == placement.end() ? oracle.outside(point) : oracle.inside(disk, point);
    worst = std::max(worst, std::abs(field[pixel] - exact));
  }
  return worst;
}

}  // namespace flatspeckle::wave
