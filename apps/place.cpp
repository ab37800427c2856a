#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <sstream>

#include "apps/datasets.h"
#include "apps/key_values.h"
#include "apps/run_options.h"
#include "apps/subcommands.h"
#include "core/error.h"
#include "core/result/atomic_file.h"
#include "core/result/provenance.h"
#include "core/result/result_group.h"
#include "core/result/version.h"
#include "core/run/stopwatch.h"
#include "flatland/media/structure_factor.h"
#include "flatland/placement/placement.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::apps {

const DatasetTable placement_table{
    .name = "placement",
    .rows = {},
    .attributes = {{"", "placement", "text", "rule"},
                   {"", "count", "uint64", "number of scatterers"},
                   {"", "min_gap", "float64", "least distance between the rims of disks"}}};

namespace {

using Kind = PlacementRule::Kind;

struct PlaceKeys {
  std::optional<double> width, depth, packing_fraction, min_gap;
  std::vector<double> radii, fractions;
  std::optional<std::int64_t> count;
  std::optional<std::string> placement;
  std::string structure;
  std::optional<std::int64_t> realizations;
  RunSettings run;  ///< out and seed
};

/// What is drawn: disks of these radii, one each, or points (radii empty).
struct Drawing {
  Domain box;
  Kind kind = Kind::poisson;
  std::vector<double> radii;
  std::size_t count = 0;
  double min_gap = 0;

  double packing(double gap) const {
    double area = 0;
    for (double radius : radii) area += std::numbers::pi * std::pow(radius + gap / 2, 2);
    return area / box.area();
  }
  bool equal_disks() const {
    return !radii.empty() &&
           std::all_of(radii.begin(), radii.end(), [&](double r) { return r == radii.front(); });
  }
};

void add_options(Options& options, PlaceKeys& keys) {
  options.add("--width", keys.width, "Width of the box, |x| <= width/2");
  options.add("--depth", keys.depth, "Depth of the box, 0 <= z <= depth");
  options.add("--radii", keys.radii, "Radius of each species of disks; none: points");
  options.add("--fractions", keys.fractions,
              "Share of each species in the number of disks (default equal)");
  options.add("--count", keys.count, "Number of scatterers");
  options.add("--packing_fraction", keys.packing_fraction,
              "Share of the box's area that the disks cover, instead of count");
  options.add("--placement", keys.placement,
              "poisson (points), hard_disk (one disk after the other) or equilibrium (the fluid "
              "of hard disks)");
  options.add("--min_gap", keys.min_gap,
              "Least distance between the rims of disks (default 1e-3 of the smallest radius)");
  options.add_with_default("--seed", keys.run.seed, "Seed");
  options.add("--structure", keys.structure,
              "Result file (HDF5) for the structure factor S(q) over realizations");
  options.keep_out_of_scene_file("--structure");
  options.add("--realizations", keys.realizations,
              "Placements that S(q) is averaged over (default 100)");
  options.add("--out", keys.run.out, "Placement file (CSV)");
  options.keep_out_of_scene_file("--out");
}

double given_positive(const std::string& key, const std::optional<double>& value) {
  if (!value) throw InputError(key + " is not given: must be positive");
  return positive(key, *value);
}

Kind chosen_kind(const PlaceKeys& keys) {
  const bool disks = !keys.radii.empty();
  if (!keys.placement) return disks ? Kind::hard_disk : Kind::poisson;
  for (const Kind kind : {Kind::poisson, Kind::hard_disk, Kind::equilibrium}) {
    if (placement_word(kind) != *keys.placement) continue;
    if (disks == (kind == Kind::poisson))
      throw InputError("placement", *keys.placement,
                       disks ? "disks must not overlap: hard_disk or equilibrium"
                             : "disks need radii; without them: poisson");
    return kind;
  }
  throw InputError("placement", *keys.placement, "must be one of poisson hard_disk equilibrium");
}

/// Summing to 1.
std::vector<double> shares(const PlaceKeys& keys) {
  std::vector<double> shares = keys.fractions;
  if (shares.empty()) shares.assign(keys.radii.size(), 1);
  if (shares.size() != keys.radii.size())
    throw InputError("fractions", shares.size(), "numbers; must be one for each of the radii");
  for (double& share : shares) positive("fractions", share);
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= sum;
  return shares;
}

/// From count, or from packing_fraction and the mean area of a disk.
std::size_t number_of(const PlaceKeys& keys, const Domain& box, double mean_area) {
  if (keys.count.has_value() == keys.packing_fraction.has_value())
    throw InputError(keys.count ? "count, packing_fraction: give one of them"
                                : "no number is given: give count or (for disks) packing_fraction");
  if (keys.packing_fraction && mean_area == 0)
    throw InputError("packing_fraction", *keys.packing_fraction,
                     "points cover nothing; give count");
  const double number = keys.count ? static_cast<double>(*keys.count)
                                   : given_positive("packing_fraction", keys.packing_fraction) *
                                         box.area() / mean_area;
  if (!(std::llround(number) >= 1 && number <= most_scatterers))
    throw InputError(keys.count ? "count" : "packing_fraction",
                     keys.count ? number : *keys.packing_fraction,
                     "must give 1 to 10000000 scatterers");
  return static_cast<std::size_t>(std::llround(number));
}

Drawing make_drawing(const PlaceKeys& keys) {
  Drawing drawing;
  drawing.box = {Domain::Kind::box, given_positive("width", keys.width),
                 given_positive("depth", keys.depth)};
  drawing.kind = chosen_kind(keys);
  for (double radius : keys.radii) positive("radii", radius);
  const auto share = shares(keys);
  double mean_area = 0;
  for (std::size_t i = 0; i < share.size(); ++i)
    mean_area += share[i] * std::numbers::pi * keys.radii[i] * keys.radii[i];
  drawing.count = number_of(keys, drawing.box, mean_area);
  // Rounded running totals, so that the numbers of the species add up.
  double total = 0;
  for (std::size_t i = 0; i < share.size(); ++i) {
    total += share[i] * static_cast<double>(drawing.count);
    drawing.radii.resize(static_cast<std::size_t>(std::llround(total)), keys.radii[i]);
  }
  if (keys.min_gap && !(std::isfinite(*keys.min_gap) && *keys.min_gap >= 0))
    throw InputError("min_gap", *keys.min_gap, "must not be negative");
  if (keys.min_gap && keys.radii.empty())
    throw InputError("min_gap", *keys.min_gap, "is a key of disks only");
  if (!keys.radii.empty())
    drawing.min_gap = keys.min_gap.value_or(
        default_gap * *std::min_element(keys.radii.begin(), keys.radii.end()));
  return drawing;
}

Placement draw(const Drawing& drawing, std::uint64_t seed, std::uint64_t realization) {
  RandomStream random(seed, static_cast<std::uint64_t>(Stream::placement), realization);
  if (drawing.radii.empty())
    return draw_placement(
        drawing.box, {}, {.mean_count = static_cast<double>(drawing.count), .count = drawing.count},
        random);
  const auto centres =
      draw_disks(drawing.box, drawing.radii, drawing.kind, drawing.min_gap, random);
  Placement placement;
  for (std::size_t i = 0; i < centres.size(); ++i)
    placement.push_back({centres[i], {.kind = Scatterer::Kind::tm, .radius = drawing.radii[i]}});
  return placement;
}

/// Digits that read back as the same number.
std::string exact(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string csv_text(const Drawing& drawing, const Placement& placement,
                     const std::string& command_line) {
  const bool disks = !drawing.radii.empty();
  std::ostringstream text;
  text << "# flatspeckle " << version() << " (" << git_commit() << "): " << command_line << "\n# "
       << placement_word(drawing.kind) << ": " << drawing.count << (disks ? " disks" : " points")
       << " in a box of width " << exact(drawing.box.width) << ", depth "
       << exact(drawing.box.depth);
  if (disks)
    text << "; packing fraction " << drawing.packing(0) << ", min_gap " << exact(drawing.min_gap);
  text << (disks ? "\nx,z,radius\n" : "\nx,z\n");
  for (const auto& [position, scatterer] : placement)
    text << exact(position.x) << ',' << exact(position.z)
         << (disks ? ',' + exact(scatterer.radius) : "") << '\n';
  return text.str();
}

MeasuredStructureFactor measure(const Drawing& drawing, std::uint64_t seed,
                                std::uint64_t realizations) {
  // Almost four times the peak of a dense fluid, in shells narrow against it.
  const double q_max =
      8 * std::numbers::pi * std::sqrt(static_cast<double>(drawing.count) / drawing.box.area());
  MeasuredStructureFactor measured(drawing.box, q_max, q_max / 80);
  for (std::uint64_t r = 0; r < realizations; ++r) {
    std::vector<Vec2> centres;
    for (const auto& placed : draw(drawing, seed, r)) centres.push_back(placed.position);
    measured.add(centres);
  }
  return measured;
}

void write_drawing(ResultFile& file, const Drawing& drawing) {
  const ResultGroup root(file, placement_table), scene(file, scene_table);
  root.attribute("placement", std::string(placement_word(drawing.kind)));
  root.attribute("count", static_cast<std::uint64_t>(drawing.count));
  root.attribute("min_gap", drawing.min_gap);
  scene.attribute("packing_fraction", drawing.packing(0));
  scene.attribute("width", drawing.box.width);
  scene.attribute("depth", drawing.box.depth);
}

std::uint64_t checked_realizations(const PlaceKeys& keys) {
  if (keys.structure.empty() && keys.realizations)
    throw InputError("realizations", *keys.realizations, "is a key of --structure only");
  const std::int64_t number = keys.realizations.value_or(100);
  if (number < 2) throw InputError("realizations", number, "must be at least 2");
  return static_cast<std::uint64_t>(number);
}

void save_structure(const PlaceKeys& keys, const Drawing& drawing, const CommandLine& command_line,
                    std::uint64_t realizations) {
  const Stopwatch clock;
  ResultFile file(keys.structure);
  Provenance provenance{command_line.text,
                        command_line.config,
                        seed_of(keys.run),
                        "structure factor of drawn placements",
                        1,
                        utc_now()};
  std::optional<HardDiskFluid> fluid;
  if (drawing.kind == Kind::equilibrium && drawing.equal_disks())
    fluid.emplace(drawing.packing(drawing.min_gap), 2 * drawing.radii.front() + drawing.min_gap);
  write_structure(file, measure(drawing, seed_of(keys.run), realizations),
                  fluid ? &*fluid : nullptr);
  write_drawing(file, drawing);
  provenance.wall_s = clock.seconds();
  provenance.cpu_s = thread_cpu_seconds();
  provenance.samples = static_cast<double>(realizations);
  provenance.converged = true;
  write_provenance(file, provenance);
  file.commit();
  std::printf("wrote %s\n", keys.structure.c_str());
}

}  // namespace

int place(const Arguments& arguments) {
  PlaceKeys keys;
  Subcommand command("place", "Draws one placement of scatterers, which solve --placement reads");
  add_options(command.options(), keys);
  if (!command.parse(arguments)) return ExitStatus::done;

  const Drawing drawing = make_drawing(keys);
  const std::uint64_t seed = seed_of(keys.run), realizations = checked_realizations(keys);
  if (keys.run.out.empty())
    throw InputError("out is not given: name the placement file (--out FILE.csv)");
  check_writable(keys.run.out);
  if (!keys.structure.empty()) check_result_path(keys.structure);
  const std::string text = csv_text(drawing, draw(drawing, seed, 0), command.command_line().text);
  replace_file(keys.run.out, std::as_bytes(std::span(text)));
  std::printf("%zu scatterers, packing fraction %.3g\nwrote %s\n", drawing.count,
              drawing.packing(0), keys.run.out.c_str());
  if (!keys.structure.empty()) save_structure(keys, drawing, command.command_line(), realizations);
  return ExitStatus::done;
}

}  // namespace flatspeckle::apps
