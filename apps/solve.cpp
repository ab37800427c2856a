#include <cstdio>
#include <numbers>
#include <sstream>

#include <omp.h>

#include "apps/field_map_output.h"
#include "apps/run_options.h"
#include "apps/scene_options.h"
#include "apps/subcommands.h"
#include "core/error.h"
#include "core/result/provenance.h"
#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/stopwatch.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/maps/map_datasets.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::apps {

namespace {

bool is_placement_rule(const SceneSpec& spec) {
  return !spec.placement || spec.placement == "poisson" || spec.placement == "hard_disk" ||
         spec.placement == "equilibrium";
}

wave::Method solver_named(const std::string& name) {
  using enum wave::Method;
  if (name == "auto") return automatic;
  if (name == "dense") return dense;
  if (name == "fast") return fast;
  if (name == "krylov") return krylov;
  throw InputError("solver", name, "must be one of auto dense fast krylov");
}

/// A file brings its own positions: keys that would place scatterers contradict it. (A stored
/// configuration names the default domain.)
void refuse_medium_keys(const Subcommand& command, const SceneSpec& spec) {
  const std::string& path = *spec.placement;
  if (spec.domain != SceneSpec().domain)
    throw InputError("domain: the placement comes from " + path + "; leave it out");
  for (const char* key :
       {"width", "depth", "count", "density", "mean_free_path", "optical_depth", "min_gap"})
    if (command.given(key))
      throw InputError(std::string(key) + ": the placement comes from " + path + "; leave it out");
}

Placement make_placement(const SceneSpec& spec, const Subcommand& command, std::uint64_t seed) {
  if (!is_placement_rule(spec)) {
    refuse_medium_keys(command, spec);
    const Scatterer scatterer = make_scatterer(spec);
    if (scatterer.kind == Scatterer::Kind::hg)
      throw InputError(
          "scatterer", spec.scatterer,
          "is a bulk phase function; the exact solver needs point, soft, hard, tm or te");
    return read_placement(*spec.placement, scatterer);
  }
  const Scene scene = make_scene(spec);
  if (scene.domain.kind == Domain::Kind::slab)
    throw InputError("domain", spec.domain, "the exact solver needs a box");
  if (!scene.medium.has_scatterers)
    throw InputError(
        "scatterer", spec.scatterer,
        "is a bulk phase function; the exact solver needs point, soft, hard, tm or te");
  RandomStream random(seed, static_cast<std::uint64_t>(Stream::placement), 0);
  return draw_placement(scene.domain, scene.scatterer, scene.placement, random);
}

void write_solve_provenance(ResultFile& file, const CommandLine& command_line,
                            const RunSettings& settings, const std::string& started,
                            const wave::WaveSolution& solution, const std::string& map,
                            const Stopwatch& clock) {
  std::ostringstream plan;
  plan << solution.system().placement().size() << " scatterers, " << solution.system().unknowns()
       << " unknowns: " << solution.method() << (map.empty() ? "" : "; ") << map;
  Provenance provenance{command_line.text, command_line.config,  seed_of(settings),
                        plan.str(),        threads_of(settings), started};
  provenance.wall_s = clock.seconds();
  provenance.cpu_s = process_cpu_seconds();
  provenance.samples = 1;
  provenance.converged = true;
  write_provenance(file, provenance);
}

void print_summary(const wave::WaveSolution& solution) {
  const wave::Diagnosis& diagnosis = solution.diagnosis();
  std::printf("%zu scatterers, %zu unknowns: %s\nresidual %.1e, ",
              solution.system().placement().size(), solution.system().unknowns(),
              solution.method().c_str(), diagnosis.residual);
  if (diagnosis.condition >= 0) std::printf("condition %.1e, ", diagnosis.condition);
  std::printf("boundary residual %.1e\n", diagnosis.boundary_residual);
}

/// What the user asks.
struct SolveKeys {
  SceneSpec spec;
  RunSettings settings;
  MapSettings map;
  double tolerance = wave::SolveOptions().tolerance;
  std::string solver = "auto";
};

void add_options(Options& options, SolveKeys& keys) {
  add_scatterer_options(options, keys.spec);
  add_bulk_options(options, keys.spec);
  add_medium_options(options, keys.spec);
  options.describe(
      "--placement",
      "CSV with columns x, z [, radius [, index_re, index_im]]; or poisson, hard_disk or "
      "equilibrium, to draw one");
  add_view_options(options, keys.spec);
  add_map_options(options, keys.map);
  options.add_with_default("--tolerance", keys.tolerance, "Relative accuracy of the fields");
  options.add_with_default(
      "--solver", keys.solver,
      "auto, dense, fast (direct, for thousands of unknowns and more) or krylov "
      "(iterative, for weak scattering)");
  add_thread_option(options, keys.settings);
  options.add_with_default("--seed", keys.settings.seed, "Seed of a drawn placement");
  add_output_option(options, keys.settings);
}

void check(const SolveKeys& keys) {
  make_request(keys.spec);  // checks lights and views
  if (!(keys.tolerance > 0 && keys.tolerance < 1))
    throw InputError("tolerance", keys.tolerance, "must be in (0, 1)");
  solver_named(keys.solver);
  threads_of(keys.settings);
  if (keys.settings.out.empty())
    throw InputError("out is not given: name the result file (--out FILE.h5)");
  check_result_path(keys.settings.out);
}

std::vector<Vec2> sensors_of(const SceneSpec& spec, const Placement& placement) {
  std::vector<Vec2> sensors;
  if (!spec.near_sensors.empty()) sensors = read_points(spec.near_sensors);
  for (const Vec2& sensor : sensors) require_outside(placement, sensor);
  return sensors;
}

wave::WaveSolution solved(const SolveKeys& keys, const Placement& placement,
                          const std::optional<wave::MapGrid>& grid,
                          const std::vector<Vec2>& sensors) {
  wave::SolveOptions options{.tolerance = keys.tolerance, .sensors = sensors};
  options.method = solver_named(keys.solver);
  if (grid)
    for (const Vec2& point : wave::map_sensors(*grid, placement)) options.sensors.push_back(point);
  return wave::solve(placement, 2 * std::numbers::pi / keys.spec.wavelength, keys.spec.light_angles,
                     options);
}

}  // namespace

int solve(const Arguments& arguments) {
  const Stopwatch clock;
  const std::string started = utc_now();
  SolveKeys keys;
  Subcommand command("solve", "Exact fields of one placement of scatterers");
  add_options(command.options(), keys);
  if (!command.parse(arguments)) return ExitStatus::done;
  settle_views(command, keys.spec);
  check(keys);
  omp_set_num_threads(threads_of(keys.settings));
  const auto grid = map_grid(keys.map, keys.spec.wavelength);
  const Placement placement = make_placement(keys.spec, command, seed_of(keys.settings));
  const auto sensors = sensors_of(keys.spec, placement);
  const auto solution = solved(keys, placement, grid, sensors);

  if (grid) catch_interrupts();  // which must not leave the file that a map is written to
  const std::string& out = keys.settings.out;
  ResultFile file(out, grid ? ResultFile::Storage::disk : ResultFile::Storage::memory);
  wave::write_solution(file, solution, keys.spec.view_angles, sensors);
  std::string map_method;
  if (grid) {
    const auto method = wave::write_map(file, solution, *grid, keys.tolerance);
    if (!method) return ExitStatus::interrupted_for_good;
    map_method = *method;
  }
  write_solve_provenance(file, command.command_line(), keys.settings, started, solution, map_method,
                         clock);
  if (is_placement_rule(keys.spec))
    write_medium(file, make_scene(keys.spec));
  else
    ResultGroup(file, scene_table).attribute("wavelength", keys.spec.wavelength);
  file.commit();
  print_summary(solution);
  if (grid) std::printf("%s\n", map_method.c_str());
  std::printf("wrote %s\n", out.c_str());
  return ExitStatus::done;
}

}  // namespace flatspeckle::apps
