#include "flatland/placement/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "core/keys/chosen.h"
#include "core/keys/csv.h"
#include "flatland/placement/cell_grid.h"
#include "flatland/placement/equilibrium_disks.h"

namespace flatspeckle {

namespace {

Vec uniform_in(const Domain& box, RandomStream& random) {
  const double x = (random.uniform() - 0.5) * box.width, z = random.uniform() * box.depth;
  return {x, z, box.height > 0 ? (random.uniform() - 0.5) * box.height : 0};
}

/// Draws a Poisson-distributed number: the number of arrivals of a unit-rate process up to the time
/// `mean`.
std::uint64_t poisson_number(double mean, RandomStream& random) {
  std::uint64_t number = 0;
  for (double arrival = -std::log(random.uniform()); arrival < mean;
       arrival -= std::log(random.uniform()))
    ++number;
  return number;
}

/// Places disks or spheres by random sequential addition. Radii include half the gap.
std::vector<Vec> add_disks(const Domain& box, std::span<const double> radii, RandomStream& random) {
  CellGrid grid(2 * *std::max_element(radii.begin(), radii.end()));
  std::vector<Vec> centres;
  constexpr std::uint64_t most_tries = 100'000'000;
  for (std::uint64_t tries = 0; centres.size() < radii.size(); ++tries) {
    if (tries == most_tries)
      throw InputError("the scatterers cannot be packed: random sequential addition of " +
                       std::to_string(radii.size()) +
                       " of them does not end; lower the density or min_gap");
    const Vec position = uniform_in(box, random);
    const double radius = radii[centres.size()];
    const bool taken = grid.any_near(position, [&](Vec other, std::size_t number) {
      return length(position - other) < radius + radii[number];
    });
    if (taken) continue;
    grid.insert(position, centres.size());
    centres.push_back(position);
  }
  return centres;
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
    if (const auto fault = index_fault(scatterer.index); !fault.empty())
      throw InputError(path + ", index", scatterer.index, fault);
  }
  return scatterer;
}

}  // namespace

PlacementRule::Kind placement_kind(const std::optional<std::string>& word, bool disks) {
  using Rule = PlacementRule::Kind;
  if (!word) return disks ? Rule::hard_disk : Rule::poisson;
  const Rule rule = chosen<Rule>(placement_words, *word);
  if (disks == (rule == Rule::poisson))
    throw InputError("placement", *word,
                     disks ? "must be hard_disk or equilibrium for disks, which must not overlap"
                           : "must be poisson for scatterers without a radius");
  return rule;
}

void require_placeable(const PlacementRule& rule) {
  if (rule.mean_count > most_scatterers)
    throw InputError("count", rule.mean_count,
                     "must be at most 1e7, the largest number that can be solved");
}

Placement draw_placement(const Domain& box, const Scatterer& scatterer, const PlacementRule& rule,
                         RandomStream& random) {
  require_placeable(rule);
  Placement placement;
  if (rule.kind != PlacementRule::Kind::poisson) {
    const std::vector<double> radii(static_cast<std::size_t>(std::llround(rule.mean_count)),
                                    scatterer.radius);
    for (const Vec& centre : draw_disks(box, radii, rule.kind, rule.min_gap, random))
      placement.push_back({centre, scatterer});
    return placement;
  }
  const std::uint64_t count = rule.count ? *rule.count : poisson_number(rule.mean_count, random);
  placement.reserve(count);
  while (placement.size() < count) placement.push_back({uniform_in(box, random), scatterer});
  return placement;
}

std::vector<Vec> draw_disks(const Domain& box, std::span<const double> radii,
                            PlacementRule::Kind kind, double min_gap, RandomStream& random) {
  if (radii.empty()) return {};
  // The largest disks are placed first, because they would not fit among many small ones.
  std::vector<std::size_t> order(radii.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
  std::vector<double> reaches;
  double packing = 0;
  for (std::size_t disk : order) {
    reaches.push_back(radii[disk] + min_gap / 2);
    packing += Scatterer{.radius = reaches.back()}.content(box.height > 0 ? 3 : 2) / box.content();
  }
  check_packing(box, kind, packing, 2 * reaches.front());
  const auto drawn = kind == PlacementRule::Kind::equilibrium
                         ? draw_equilibrium_disks(box, reaches, random)
                         : add_disks(box, reaches, random);
  std::vector<Vec> centres(radii.size());
  for (std::size_t i = 0; i < order.size(); ++i) centres[order[i]] = drawn[i];
  return centres;
}

namespace {

/// Throws InputError for spheres that are packed too densely. Random sequential addition of spheres
/// jams at 0.38; the equilibrium fluid freezes at 0.494.
void check_sphere_packing(bool equilibrium, double packing) {
  if (packing <= 1.003 * (equilibrium ? 0.49 : 0.33)) return;
  throw InputError(
      "packing fraction (with min_gap)", packing,
      equilibrium
          ? "must be at most 0.49 for spheres, because the fluid of hard spheres freezes at 0.494; "
            "lower the density, the radius or min_gap"
          : "must be at most 0.33 for spheres with placement = hard_disk; lower the density, the "
            "radius or min_gap, or use placement = equilibrium");
}

}  // namespace

void check_packing(const Domain& box, PlacementRule::Kind kind, double packing, double largest) {
  const bool equilibrium = kind == PlacementRule::Kind::equilibrium;
  const bool space = box.height > 0;
  if (space) check_sphere_packing(equilibrium, packing);
  // The default gap raises the packing fraction slightly: the slack of 0.2 % accepts disks that
  // would be exactly at the limit without it.
  if (!space && packing > 1.002 * (equilibrium ? 0.69 : 0.5))
    throw InputError(
        "packing fraction (with min_gap)", packing,
        equilibrium
            ? "must be at most 0.69, because the fluid of hard disks freezes near 0.7; lower the "
              "density, the radius or min_gap"
            : "must be at most 0.5 for placement = hard_disk; lower the density, the radius or "
              "min_gap, or use placement = equilibrium");
  const bool slab = box.kind == Domain::Kind::slab;
  for (const auto& [key, extent] : {std::pair{"width", box.width},
                                    {"depth", box.depth},
                                    {"height", space ? box.height : box.width}})
    if (equilibrium && !slab && extent < 3.001 * largest)
      throw InputError(key, extent,
                       std::string("placement = equilibrium requires a box more than three times "
                                   "as wide and deep as the largest ") +
                           (space ? "sphere" : "disk") + " with its gap, " +
                           std::to_string(largest));
}

Placement read_placement(const std::string& path, const Scatterer& scatterer, bool in_space) {
  std::vector<std::string> columns{"x", "z", "radius", "index_re", "index_im"};
  if (in_space) columns.emplace_back("y");
  const Table table = read_key_table("placement", path, columns, true);
  for (const char* name : {"x", "z"})
    if (!table.has(name))
      throw InputError("placement", path, std::string("column ") + name + " is missing");
  if (table.has("index_im") && !table.has("index_re"))
    throw InputError(path + ": the column index_im requires a column index_re");
  if (scatterer.is_disk() && !table.has("radius") && scatterer.radius <= 0)
    throw InputError(path + ": column radius is missing, and the key radius is not given");
  Placement placement;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const Vec position{table.column("x")[row], table.column("z")[row],
                       table.has("y") ? table.column("y")[row] : 0};
    placement.push_back({position, row_scatterer(table, row, scatterer, path)});
  }
  check_no_overlap(placement);
  return placement;
}

void require_outside(const Placement& placement, Vec sensor) {
  for (const auto& [position, scatterer] : placement) {
    const double distance = length(sensor - position);
    if (scatterer.is_disk() ? distance >= scatterer.radius : distance > 0) continue;
    throw InputError("near_sensors",
                     "(" + std::to_string(sensor.x) + ", " + std::to_string(sensor.z) +
                         (sensor.y == 0 ? "" : ", y " + std::to_string(sensor.y)) + ")",
                     "must lie outside every scatterer; use a map for the field inside");
  }
}

double smallest_gap(const Placement& placement, double within) {
  double largest = 0, smallest = within;
  for (const auto& placed : placement) largest = std::max(largest, placed.scatterer.disk_radius());
  CellGrid grid(2 * largest + within);
  for (std::size_t j = 0; j < placement.size(); ++j) {
    const auto& [position, scatterer] = placement[j];
    grid.any_near(position,
                  [&, here = position, radius = scatterer.disk_radius()](Vec other, std::size_t l) {
                    const double reach = radius + placement[l].scatterer.disk_radius();
                    smallest = std::min(smallest, length(here - other) - reach);
                    return false;
                  });
    grid.insert(position, j);
  }
  return smallest;
}

void check_no_overlap(const Placement& placement) {
  double largest = 0;
  for (const auto& placed : placement) largest = std::max(largest, placed.scatterer.disk_radius());
  constexpr double tiny = 1e-6;  // points overlap only if they are equal
  CellGrid grid(largest > 0 ? 2 * largest : tiny);
  for (std::size_t j = 0; j < placement.size(); ++j) {
    const PlacedScatterer& here = placement[j];
    grid.any_near(here.position, [&, j](Vec other, std::size_t l) {
      const double reach = here.scatterer.disk_radius() + placement[l].scatterer.disk_radius();
      if (length(here.position - other) > reach) return false;
      throw InputError("placement: scatterers " + std::to_string(l + 1) + " and " +
                       std::to_string(j + 1) + " overlap or touch");
    });
    grid.insert(here.position, j);
  }
}

}  // namespace flatspeckle
