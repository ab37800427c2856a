#include "flatland/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/csv.h"
#include "core/error.h"
#include "flatland/cell_grid.h"

namespace flatspeckle {

namespace {

Vec2 uniform_in(const Domain& box, RandomStream& random) {
  const double x = (random.uniform() - 0.5) * box.width;
  return {x, random.uniform() * box.depth};
}

/// Counts unit-rate arrivals until the mean is passed.
std::uint64_t poisson_number(double mean, RandomStream& random) {
  std::uint64_t number = 0;
  for (double arrival = -std::log(random.uniform()); arrival < mean;
       arrival -= std::log(random.uniform()))
    ++number;
  return number;
}

Placement draw_hard_disks(const Domain& box, const Scatterer& scatterer, const PlacementRule& rule,
                          RandomStream& random) {
  const auto count = static_cast<std::size_t>(std::llround(rule.mean_count));
  const double least_distance = 2 * scatterer.radius + rule.min_gap;
  CellGrid grid(least_distance);
  Placement placement;
  placement.reserve(count);
  constexpr std::uint64_t most_tries = 100'000'000;
  for (std::uint64_t tries = 0; placement.size() < count; ++tries) {
    if (tries == most_tries)
      throw InputError("the disks cannot be packed: placing " + std::to_string(count) +
                       " one after the other does not end; lower the density or min_gap");
    const Vec2 position = uniform_in(box, random);
    const bool taken = grid.any_near(position, [&](Vec2 other, std::size_t) {
      return length(position - other) < least_distance;
    });
    if (taken) continue;
    grid.insert(position, placement.size());
    placement.push_back({position, scatterer});
  }
  return placement;
}

double disk_radius(const Scatterer& scatterer) {
  return scatterer.is_disk() ? scatterer.radius : 0;
}

Scatterer row_scatterer(const Table& table, std::size_t row, Scatterer scatterer,
                        const std::string& path) {
  if (table.has("radius")) {
    scatterer.radius = table.column("radius")[row];
    if (scatterer.is_disk() && scatterer.radius <= 0)
      throw InputError(path + ", radius", scatterer.radius, "must be positive");
  }
  if (table.has("index_re")) {
    const double imaginary = table.has("index_im") ? table.column("index_im")[row] : 0;
    scatterer.index = {table.column("index_re")[row], imaginary};
    if (scatterer.index == 0.0 || imaginary < 0)
      throw InputError(path + ", index", scatterer.index, "must not be 0 nor amplify");
  }
  return scatterer;
}

}  // namespace

Placement draw_placement(const Domain& box, const Scatterer& scatterer, const PlacementRule& rule,
                         RandomStream& random) {
  constexpr double most_scatterers = 1e7;
  if (rule.mean_count > most_scatterers)
    throw InputError("count", rule.mean_count,
                     "too many to place, more than this machine can solve");
  if (rule.kind == PlacementRule::Kind::hard_disk)
    return draw_hard_disks(box, scatterer, rule, random);
  const std::uint64_t count = rule.count ? *rule.count : poisson_number(rule.mean_count, random);
  Placement placement;
  placement.reserve(count);
  while (placement.size() < count) placement.push_back({uniform_in(box, random), scatterer});
  return placement;
}

Placement read_placement(const std::string& path, const Scatterer& scatterer) {
  const Table table = read_csv(path);
  for (const char* name : {"x", "z"})
    if (!table.has(name)) throw InputError(path + ": column " + name + " is missing");
  if (table.has("index_im") && !table.has("index_re"))
    throw InputError(path + ": column index_re is missing beside index_im");
  if (scatterer.is_disk() && !table.has("radius") && scatterer.radius <= 0)
    throw InputError(path + ": column radius is missing, and the key radius is not given");
  Placement placement;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const Vec2 position{table.column("x")[row], table.column("z")[row]};
    placement.push_back({position, row_scatterer(table, row, scatterer, path)});
  }
  check_no_overlap(placement);
  return placement;
}

void check_no_overlap(const Placement& placement) {
  double largest = 0;
  for (const auto& placed : placement) largest = std::max(largest, disk_radius(placed.scatterer));
  CellGrid grid(largest > 0 ? 2 * largest : 1);
  for (std::size_t j = 0; j < placement.size(); ++j) {
    const PlacedScatterer& here = placement[j];
    grid.any_near(here.position, [&, j](Vec2 other, std::size_t l) {
      const double reach = disk_radius(here.scatterer) + disk_radius(placement[l].scatterer);
      if (length(here.position - other) > reach) return false;
      throw InputError("placement: scatterers " + std::to_string(l + 1) + " and " +
                       std::to_string(j + 1) + " overlap or touch");
    });
    grid.insert(here.position, j);
  }
}

}  // namespace flatspeckle
