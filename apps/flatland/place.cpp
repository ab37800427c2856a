#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <sstream>

#include "apps/command/subcommands.h"
#include "apps/results/datasets.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/atomic_file.h"
#include "core/result/result_group.h"
#include "core/result/version.h"
#include "core/run/interrupt.h"
#include "core/session/session.h"
#include "flatland/media/structure_factor.h"
#include "flatland/placement/placement.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::apps {

const DatasetTable placement_table{
    .name = "placement",
    .rows = {},
    .attributes = {{"", "placement", "text", "placement rule"},
                   {"", "count", "uint64", "number of scatterers"},
                   {"", "min_gap", "float64", "smallest distance between the rims of disks"}}};

namespace {

using Kind = PlacementRule::Kind;

struct PlaceKeys {
  std::int64_t dimension = 2;
  std::optional<double> width, depth, height, packing_fraction, min_gap;
  std::vector<double> radii, fractions;
  std::optional<std::int64_t> count;
  std::optional<std::string> placement;
  std::string structure;
  std::int64_t realizations = 100;
  RunSettings run;  ///< only the members out and seed are used
};

void add_keys(Keys& keys, PlaceKeys& values) {
  keys.group("Placement");
  keys.add("width", values.width, "Width of the box: |x| <= width/2").positive().unit("length");
  keys.add("depth", values.depth, "Depth of the box: 0 <= z <= depth").positive().unit("length");
  keys.add("dimension", values.dimension, "2: disks and points of the plane; 3: spheres and points")
      .from(2, 3);
  keys.add("height", values.height, "Height of the box: |y| <= height/2")
      .positive()
      .unit("length")
      .only_of("dimension = 3");
  keys.add("radii", values.radii, "Radius of each species of disks or spheres (default: points)")
      .positive()
      .unit("length");
  keys.add("fractions", values.fractions,
           "Number fraction of each species of disks (default: equal fractions)")
      .positive()
      .only_of("disks (radii)");
  keys.add("count", values.count, "Number of scatterers").from(1, most_scatterers);
  keys.add(
          "packing_fraction", values.packing_fraction,
          "Fraction of the box's area (in space of its volume) that disks or spheres fill, instead "
          "of count")
      .positive()
      .only_of("disks and spheres");
  keys.add("placement", values.placement,
           "poisson for points; for disks hard_disk (random sequential addition) or equilibrium "
           "(fluid of hard disks or spheres)")
      .one_of(placement_words);
  keys.add("min_gap", values.min_gap,
           "Smallest distance between the rims of disks (default: 1e-3 of the smallest radius)")
      .not_negative()
      .unit("length")
      .only_of("disks");
  add_seed_key(keys, values.run, "Random seed");
  keys.group("Structure factor");
  keys.add("structure", values.structure,
           "Result file (HDF5) for the structure factor S(q), averaged over realizations")
      .no_file();
  keys.add("realizations", values.realizations, "Number of placements over which S(q) is averaged")
      .from(2, std::numeric_limits<double>::infinity())
      .only_of("--structure");
  add_output_key(keys, values.run, "Placement file (CSV)");
}

/// The placement to draw: a disk for each radius, or points if `radii` is empty.
struct PlacementDraw {
  Domain box;
  Kind kind = Kind::poisson;
  std::vector<double> radii;
  std::size_t count = 0;
  double min_gap = 0;

  bool in_space() const { return box.height > 0; }
  double packing(double gap) const {
    double content = 0;
    for (double radius : radii) content += content_of(radius + gap / 2);
    return content / box.content();
  }
  double content_of(double radius) const {
    return Scatterer{.radius = radius}.content(in_space() ? 3 : 2);
  }
  bool equal_disks() const {
    return !radii.empty() &&
           std::all_of(radii.begin(), radii.end(), [&](double r) { return r == radii.front(); });
  }
};

/// Returns the number fractions of the species of disks, normalised to the sum 1.
std::vector<double> shares(const Keys& keys, const PlaceKeys& values) {
  std::vector<double> shares = keys.read(values.fractions);
  if (shares.empty()) shares.assign(values.radii.size(), 1);
  if (shares.size() != values.radii.size())
    throw InputError("fractions: has " + std::to_string(shares.size()) +
                     " values, must have one for each of the radii");
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= sum;
  return shares;
}

/// Returns the number of scatterers: the key `count`, or computed from packing_fraction and the
/// mean area of a disk or volume of a sphere.
std::size_t number_of(const PlaceKeys& values, const Domain& box, double mean_content) {
  if (values.packing_fraction && mean_content == 0)
    throw InputError("packing_fraction", *values.packing_fraction,
                     "requires disks or spheres (radii); give count for points");
  if (values.count.has_value() == values.packing_fraction.has_value())
    throw InputError(values.count
                         ? "count, packing_fraction: give only one of them"
                         : "count is not given: give count or, for disks, packing_fraction");
  if (values.count) return static_cast<std::size_t>(*values.count);
  const double number = *values.packing_fraction * box.content() / mean_content;
  if (!(std::llround(number) >= 1 && number <= most_scatterers))
    throw InputError("packing_fraction", *values.packing_fraction,
                     "must result in 1 to 10000000 scatterers");
  return static_cast<std::size_t>(std::llround(number));
}

PlacementDraw make_drawing(const Keys& keys, const PlaceKeys& values) {
  PlacementDraw drawing;
  drawing.box = {Domain::Kind::box, keys.required(values.width), keys.required(values.depth)};
  if (keys.read(values.dimension) == 3) drawing.box.height = keys.required(values.height);
  const auto& radii = keys.read(values.radii);
  const bool disks = !radii.empty();
  drawing.kind = placement_kind(keys.read(values.placement), disks);
  keys.read(values.count);
  double mean_content = 0, total = 0;
  const auto share = disks ? shares(keys, values) : std::vector<double>{};
  for (std::size_t i = 0; i < share.size(); ++i)
    mean_content += share[i] * drawing.content_of(radii[i]);
  drawing.count = number_of(values, drawing.box, mean_content);
  if (!disks) return drawing;
  keys.read(values.packing_fraction);
  // Cumulative numbers are rounded, so that the numbers of disks of all species add up to the total
  // number.
  for (std::size_t i = 0; i < share.size(); ++i) {
    total += share[i] * static_cast<double>(drawing.count);
    drawing.radii.resize(static_cast<std::size_t>(std::llround(total)), radii[i]);
  }
  drawing.min_gap = keys.read(values.min_gap)
                        .value_or(default_gap * *std::min_element(radii.begin(), radii.end()));
  return drawing;
}

Placement draw(const PlacementDraw& drawing, std::uint64_t seed, std::uint64_t realization) {
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

std::string csv_text(const PlacementDraw& drawing, const Placement& placement,
                     const std::string& command_line) {
  const bool disks = !drawing.radii.empty(), space = drawing.in_space();
  std::ostringstream text;
  // names come first, since NumPy takes them from the first line
  text << "x,z" << (space ? ",y" : "") << (disks ? ",radius" : "") << "\n# flatspeckle "
       << version() << " (" << git_commit() << "): " << command_line << "\n# "
       << placement_word(drawing.kind) << ": " << drawing.count
       << (!disks  ? " points"
           : space ? " spheres"
                   : " disks")
       << " in a box of width " << number_text(drawing.box.width) << ", depth "
       << number_text(drawing.box.depth);
  if (space) text << ", height " << number_text(drawing.box.height);
  if (disks)
    text << "; packing fraction " << drawing.packing(0) << ", min_gap "
         << number_text(drawing.min_gap);
  text << '\n';
  for (const auto& [position, scatterer] : placement)
    text << number_text(position.x) << ',' << number_text(position.z)
         << (space ? ',' + number_text(position.y) : "")
         << (disks ? ',' + number_text(scatterer.radius) : "") << '\n';
  return text.str();
}

MeasuredStructureFactor measure(const PlacementDraw& drawing, std::uint64_t seed,
                                std::uint64_t realizations) {
  // The largest q is almost four times the position of the peak of the structure factor of a dense
  // fluid. The shells in q are narrow compared with this peak.
  const double q_max =
      8 * std::numbers::pi * std::sqrt(static_cast<double>(drawing.count) / drawing.box.content());
  MeasuredStructureFactor measured(drawing.box, q_max, q_max / 80);
  for (std::uint64_t r = 0; r < realizations; ++r) {
    std::vector<Vec> centres;
    for (const auto& placed : draw(drawing, seed, r)) centres.push_back(placed.position);
    measured.add(centres);
  }
  return measured;
}

void write_drawing(ResultFile& file, const PlacementDraw& drawing) {
  const ResultGroup root(file, placement_table), scene(file, scene_table);
  root.attribute("placement", std::string(placement_word(drawing.kind)));
  root.attribute("count", static_cast<std::uint64_t>(drawing.count));
  root.attribute("min_gap", drawing.min_gap);
  scene.attribute("packing_fraction", drawing.packing(0));
  scene.attribute("width", drawing.box.width);
  scene.attribute("depth", drawing.box.depth);
}

int save_structure(const PlaceKeys& values, const PlacementDraw& drawing, const Session& session) {
  return session.once(ResultFile(values.structure), [&](ResultFile& file) {
    const auto realizations = static_cast<std::uint64_t>(values.realizations);
    std::optional<HardDiskFluid> fluid;
    if (drawing.kind == Kind::equilibrium && drawing.equal_disks())
      fluid.emplace(drawing.packing(drawing.min_gap), 2 * drawing.radii.front() + drawing.min_gap);
    write_structure(file, measure(drawing, session.seed(), realizations),
                    fluid ? &*fluid : nullptr);
    write_drawing(file, drawing);
    return Made{"structure factor of drawn placements", static_cast<double>(realizations)};
  });
}

void put_placement(const std::string& path, const std::string& text, bool is_all) {
  const DelayedTermination whole;
  replace_file(path, std::as_bytes(std::span(text)));
  if (is_all) ignore_termination_signals();
}

/// Prints the smallest gap between disks. Checks that disks do not overlap and that all scatterers
/// are placed. Returns the exit status.
int status_of(const PlacementDraw& drawing, const Placement& placement) {
  constexpr double rounding = 1e-9;  // relative rounding error of distances
  if (!drawing.radii.empty() && placement.size() > 1) {
    const double largest = *std::ranges::max_element(drawing.radii),
                 within = drawing.min_gap + largest, gap = smallest_gap(placement, within);
    std::printf("smallest gap %s%.6g, min_gap %.6g\n", gap < within ? "" : "above ", gap,
                drawing.min_gap);
    if (!(gap >= drawing.min_gap - rounding * (drawing.min_gap + largest))) {
      std::cerr << "warning: some disks are closer than min_gap\n";
      return ExitStatus::error_not_reached;
    }
  }
  if (placement.size() == drawing.count) return ExitStatus::done;
  std::cerr << "warning: " << drawing.count
            << " scatterers are requested; the placement contains another number\n";
  return ExitStatus::error_not_reached;
}

int draw_one(const Subcommand& command, PlaceKeys& values) {
  const Keys& keys = command.keys();
  const Session session(command.text(), keys, values.run, command.only_prints(),
                        Session::Out::other);
  const PlacementDraw drawing = make_drawing(keys, values);
  if (!keys.read(values.structure).empty()) keys.read(values.realizations);
  if (!values.structure.empty() && drawing.in_space())
    throw InputError("structure", values.structure, "requires dimension = 2");
  if (!command.settle()) return ExitStatus::done;
  std::optional<OutputLock> of_structure;
  if (!values.structure.empty()) {
    check_result_path(values.structure);
    of_structure.emplace(values.structure);
  }
  const Placement placement = draw(drawing, session.seed(), 0);
  put_placement(session.out(), csv_text(drawing, placement, command.text()),
                values.structure.empty());
  std::printf("%zu scatterers, packing fraction %.3g\nwrote %s\n", placement.size(),
              drawing.packing(0), session.out().c_str());
  const int status = status_of(drawing, placement);
  const int structure =
      values.structure.empty() ? ExitStatus::done : save_structure(values, drawing, session);
  return structure == ExitStatus::done ? status : structure;
}

}  // namespace

std::unique_ptr<Call> place(const std::string&) {
  return call_with<PlaceKeys>(
      "place", "Draws one placement of scatterers, the input of solve --placement", draw_one);
}

}  // namespace flatspeckle::apps
