#include <cstdio>
#include <numbers>
#include <sstream>

#include "apps/moments_output.h"
#include "apps/run_options.h"
#include "apps/scene_options.h"
#include "apps/subcommands.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/provenance.h"
#include "core/stopwatch.h"
#include "wave_solver/wave_solution.h"

namespace flatspeckle::apps {

namespace {

bool is_placement_rule(const SceneSpec& spec) {
  return !spec.placement || spec.placement == "poisson" || spec.placement == "hard_disk";
}

/// A file brings its own positions: keys that would place scatterers contradict it.
void refuse_medium_keys(const Subcommand& command, const std::string& path) {
  for (const char* key : {"domain", "width", "depth", "count", "density", "mean_free_path",
                          "optical_depth", "min_gap"})
    if (command.given(key))
      throw InputError(std::string(key) + ": the placement comes from " + path + "; leave it out");
}

Placement make_placement(const SceneSpec& spec, const Subcommand& command, std::uint64_t seed) {
  if (!is_placement_rule(spec)) {
    refuse_medium_keys(command, *spec.placement);
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

void write_placement(ResultFile& file, const wave::WaveSolution& solution) {
  const Placement& placement = solution.system().placement();
  std::vector<double> x, z, radius;
  for (const auto& [position, scatterer] : placement) {
    x.push_back(position.x);
    z.push_back(position.z);
    radius.push_back(scatterer.is_disk() ? scatterer.radius : 0);
  }
  const std::vector<Axis> axes = {placement.size()};
  file.dataset("placement/x", x, axes, "length", "transverse position");
  file.dataset("placement/z", z, axes, "length", "depth");
  file.dataset("placement/radius", radius, axes, "length", "radius, 0 for a point");
  std::vector<std::uint64_t> orders;
  for (int order : solution.basis_order()) orders.push_back(static_cast<std::uint64_t>(order));
  file.dataset("solve/basis_order", orders, axes, "1", "highest angular order per scatterer");
}

void write_diagnosis(ResultFile& file, const wave::Diagnosis& diagnosis) {
  const auto scalar = [&](const char* name, double value, const char* long_name) {
    file.dataset(std::string("solve/") + name, std::vector<double>{value}, {}, "1", long_name);
  };
  scalar("residual", diagnosis.residual, "relative residual of the unscaled equations");
  scalar("condition", diagnosis.condition, "condition estimate of the scaled matrix, 1-norm");
  scalar("boundary_residual", diagnosis.boundary_residual,
         "largest mismatch of the boundary conditions, unit incident waves");
}

void write_fields(ResultFile& file, const SceneSpec& spec, const wave::WaveSolution& solution,
                  const std::vector<Vec2>& sensors) {
  file.scale("light_angle", spec.light_angles, "rad", "direction of the light, from +z towards +x");
  if (!spec.view_angles.empty()) {
    std::vector<View> views;
    for (double angle : spec.view_angles) views.push_back(far_view(angle));
    write_view_axis(file, views);
    file.dataset("far_field", solution.fields(views), {"light_angle", "view_angle"}, "length^(1/2)",
                 "far-field amplitude A, phase origin at r = 0");
  }
  if (sensors.empty()) return;
  std::vector<View> views;
  for (const Vec2& point : sensors) views.push_back(near_sensor(point));
  write_view_axis(file, views);
  file.dataset("near_field", solution.fields(views), {"light_angle", "sensor"}, "1",
               "scattered field, without the incident wave");
}

void write_solve_provenance(ResultFile& file, const CommandLine& command_line,
                            const RunSettings& settings, const std::string& started,
                            const wave::WaveSolution& solution, const Stopwatch& clock) {
  std::ostringstream plan;
  plan << "dense T-matrix solution, " << solution.system().placement().size() << " scatterers, "
       << solution.system().unknowns() << " unknowns";
  Provenance provenance{
      command_line.text, command_line.config, seed_of(settings), plan.str(), 1, started};
  provenance.wall_s = clock.seconds();
  provenance.cpu_s = thread_cpu_seconds();  // one thread does it all
  provenance.samples = 1;
  provenance.converged = true;
  write_provenance(file, provenance);
}

}  // namespace

int solve(const Arguments& arguments) {
  const Stopwatch clock;
  const std::string started = utc_now();
  SceneSpec spec;
  RunSettings settings;
  wave::SolveOptions options;
  Subcommand command("solve", "Exact fields of one placement of scatterers");
  add_scatterer_options(command.options(), spec);
  add_bulk_options(command.options(), spec);
  add_medium_options(command.options(), spec);
  command.options()
      .get_option("--placement")
      ->description(
          "CSV with columns x, z [, radius [, index_re, index_im]]; or poisson or hard_disk, to "
          "draw one");
  add_view_options(command.options(), spec);
  command.options()
      .add_option("--tolerance", options.tolerance, "Relative accuracy of the fields")
      ->capture_default_str();
  command.options()
      .add_option("--seed", settings.seed, "Seed of a drawn placement")
      ->capture_default_str();
  add_output_option(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;

  settle_views(command, spec);
  make_request(spec);  // checks lights and views
  if (!(options.tolerance > 0 && options.tolerance < 1))
    throw InputError("tolerance", options.tolerance, "must be in (0, 1)");
  if (settings.out.empty())
    throw InputError("out is not given: name the result file (--out FILE.h5)");
  check_writable(settings.out);
  if (!spec.near_sensors.empty()) options.sensors = read_points(spec.near_sensors);
  const auto solution =
      wave::solve(make_placement(spec, command, seed_of(settings)),
                  2 * std::numbers::pi / spec.wavelength, spec.light_angles, options);
  ResultFile file(settings.out);
  write_fields(file, spec, solution, options.sensors);
  write_placement(file, solution);
  write_diagnosis(file, solution.diagnosis());
  write_solve_provenance(file, command.command_line(), settings, started, solution, clock);
  if (is_placement_rule(spec)) write_medium(file, make_scene(spec));
  file.commit();
  std::printf(
      "%zu scatterers, %zu unknowns: residual %.1e, condition %.1e, boundary residual %.1e\n"
      "wrote %s\n",
      solution.system().placement().size(), solution.system().unknowns(),
      solution.diagnosis().residual, solution.diagnosis().condition,
      solution.diagnosis().boundary_residual, settings.out.c_str());
  return ExitStatus::done;
}

}  // namespace flatspeckle::apps
