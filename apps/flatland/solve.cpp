#include <algorithm>
#include <cstdio>
#include <map>
#include <numbers>
#include <sstream>

#include "apps/command/subcommands.h"
#include "apps/results/field_map_output.h"
#include "apps/results/wavelengths.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "core/numbers/blas.h"
#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/progress.h"
#include "core/run/stopwatch.h"
#include "core/session/session.h"
#include "flatland/scene/index_fields.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/clusters/cluster_file.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/graded/graded_fields.h"
#include "wave_solver/maps/map_datasets.h"
#include "wave_solver/solutions/spectrum.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::apps {

namespace {

/// What the user asks.
struct SolveKeys {
  SceneSpec spec;
  RunSettings run;
  MapSettings map;
  SpectrumSettings spectrum;
  double tolerance = wave::SolveOptions().tolerance;
  std::string solver = "auto", cluster;
  std::optional<double> t_matrix_gap;
};

const std::map<std::string, wave::Method> solvers = {{"auto", wave::Method::automatic},
                                                     {"dense", wave::Method::dense},
                                                     {"fast", wave::Method::fast},
                                                     {"krylov", wave::Method::krylov}};

void add_keys(Keys& keys, SolveKeys& values) {
  add_scatterer_keys(keys, values.spec);
  add_bulk_keys(keys, values.spec);
  add_medium_keys(keys, values.spec);
  add_profile_keys(keys, values.spec);
  add_index_keys(keys, values.spec);
  keys.remove("placement");
  keys.add("placement", values.spec.placement,
           "CSV with columns x, z [, radius [, index_re, index_im]]; or poisson, hard_disk or "
           "equilibrium, to draw one; of a cluster: CSV with columns x, z [, angle]");
  add_view_keys(keys, values.spec);
  keys.add("near_sources", values.spec.near_sources,
           "CSV with columns x, z: point sources in place of plane waves")
      .only_of("media with an index_field");
  add_map_keys(keys, values.map);
  add_spectrum_keys(keys, values.spectrum);
  keys.group("Solver");
  keys.add("tolerance", values.tolerance, "Relative accuracy of the fields").between(0, 1);
  keys.add("solver", values.solver,
           "fast (direct) is for thousands of unknowns and more, krylov (iterative) for weak "
           "scattering")
      .one_of({"auto", "dense", "fast", "krylov"});
  keys.group("Clusters");
  keys.add("t_matrix_gap", values.t_matrix_gap,
           "Also write the T-matrix of the whole placement, for sources at least so far from the "
           "circle around it")
      .positive()
      .unit("length");
  keys.add("cluster", values.cluster,
           "Result with a T-matrix: its cluster stands, as one object, at each of the places")
      .file();
  add_thread_key(keys, values.run);
  add_seed_key(keys, values.run, "Seed of a drawn placement");
  add_output_key(keys, values.run);
}

bool is_placement_rule(const SceneSpec& spec) {
  return !spec.placement ||
         std::ranges::find(placement_words, *spec.placement) != placement_words.end();
}

[[noreturn]] void refuse_bulk(const SceneSpec& spec) {
  throw InputError("scatterer", spec.scatterer,
                   "is a bulk phase function; the exact solver needs point, soft, hard, tm or te");
}

/// A file brings its own positions: keys that would place scatterers find no use.
Placement placement_of_file(const Keys& keys, const SceneSpec& spec, const RunSettings& run) {
  const Scatterer scatterer = make_scatterer(keys, spec);
  if (scatterer.is_bulk()) refuse_bulk(spec);
  const std::string& path = *keys.read(spec.placement);
  try {
    keys.refuse_unread();
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + " (the placement comes from " + path + ')');
  }
  const Table table = read_csv(path);
  if (table.has("radius")) keys.disregard(spec.radius);
  if (table.has("index_re")) keys.disregard(spec.index);
  keys.disregard(run.seed);  // nothing is drawn
  return read_placement(path, scatterer);
}

Placement drawn_placement(const SceneSpec& spec, const Scene& scene, std::uint64_t seed) {
  if (scene.domain.kind == Domain::Kind::slab)
    throw InputError("domain", spec.domain, "the exact solver needs a box");
  if (!scene.medium.has_scatterers) refuse_bulk(spec);
  RandomStream random(seed, static_cast<std::uint64_t>(Stream::placement), 0);
  return draw_placement(scene, random);
}

std::string plan_of(const wave::WaveSolution& solution, const std::string& map) {
  std::ostringstream plan;
  plan << solution.system().placement().size() << " scatterers, " << solution.system().unknowns()
       << " unknowns: " << solution.method() << (map.empty() ? "" : "; ") << map;
  return plan.str();
}

void print_summary(const wave::WaveSolution& solution) {
  const wave::Diagnosis& diagnosis = solution.diagnosis();
  std::printf("%zu scatterers, %zu unknowns: %s\nresidual %.1e, ",
              solution.system().placement().size(), solution.system().unknowns(),
              solution.method().c_str(), diagnosis.residual);
  if (diagnosis.condition >= 0) std::printf("condition %.1e, ", diagnosis.condition);
  std::printf("boundary residual %.1e\n", diagnosis.boundary_residual);
}

/// Far views, near sensors, or both.
struct Sensors {
  std::vector<double> angles;
  std::vector<Vec2> points;
};

Sensors sensors_of(const Keys& keys, const SceneSpec& spec) {
  Sensors sensors;
  keys.read(spec.light_angles);
  keys.read(spec.view_angles);
  if (keys.read(spec.near_sensors).empty() || keys.given(spec.view_angles))
    sensors.angles = spec.view_angles;
  if (!spec.near_sensors.empty()) sensors.points = read_points(spec.near_sensors);
  return sensors;
}

/// Columns of a placement's file and the key `index` say the same thing as the table.
void require_index_from_table(const SceneSpec& spec, const Placement& placement) {
  if (spec.index) throw InputError("index_table, index: give one of them");
  if (spec.placement && !is_placement_rule(spec) && read_csv(*spec.placement).has("index_re"))
    throw InputError("index_table: " + *spec.placement + " has indices of its own (index_re)");
  if (std::ranges::none_of(placement, &Scatterer::is_penetrable, &PlacedScatterer::scatterer))
    throw InputError("index_table: is of tm and te cylinders");
}

wave::WaveSolution solved(const SolveKeys& values, const Placement& placement, double wavelength,
                          const std::optional<wave::MapGrid>& grid,
                          const std::vector<Vec2>& sensors) {
  wave::SolveOptions options{.tolerance = values.tolerance, .sensors = sensors};
  options.method = solvers.at(values.solver);
  if (grid)
    for (const Vec2& point : wave::map_sensors(*grid, placement)) options.sensors.push_back(point);
  return wave::solve(placement, 2 * std::numbers::pi / wavelength, values.spec.light_angles,
                     options);
}

/// One wavelength after the other; nothing where a signal came.
std::optional<wave::Spectrum> spectrum(const SolveKeys& values, const Placement& placement,
                                       const WavelengthList& wavelengths, const Sensors& sensors) {
  wave::Spectrum spectrum(sensors.angles, sensors.points);
  Progress progress("solve", "wavelengths");
  const Stopwatch watch;
  Progress::Figures figures;
  for (const double wavelength : wavelengths.values) {
    spectrum.add(wavelength, solved(values, wavelengths.at(wavelength, placement), wavelength, {},
                                    sensors.points));
    if (interrupted()) return std::nullopt;
    figures.samples += 1;
    figures.rate = figures.samples / watch.seconds();
    figures.seconds_left =
        (static_cast<double>(wavelengths.values.size()) - figures.samples) / figures.rate;
    progress.update(watch.seconds(), figures);
  }
  progress.finish(watch.seconds(), figures);
  return spectrum;
}

/// Copies of a cluster in place of scatterers: what it is comes from its file.
int solve_clusters(const Subcommand& command, const SolveKeys& values, const Session& session,
                   const Sensors& sensors) {
  const Keys& keys = command.keys();
  keys.read(values.tolerance);
  keys.read(values.solver);
  if (is_placement_rule(values.spec))
    throw InputError("placement", values.spec.placement.value_or("none"),
                     "must be a CSV with columns x, z [, angle], of the cluster's copies");
  const auto places = wave::read_places(*keys.read(values.spec.placement));
  const auto cluster = wave::read_cluster(keys.read(values.cluster));
  if (values.tolerance < cluster.tolerance)
    throw InputError("tolerance", values.tolerance,
                     "must be at least that of the cluster, " + number_text(cluster.tolerance));
  keys.disregard(values.run.seed);  // nothing is drawn
  if (!command.settle()) return ExitStatus::done;
  blas_single_thread();
  const wave::ClusterSolution solution(
      cluster.t_matrix, places, values.spec.light_angles,
      {values.tolerance, sensors.points, true, solvers.at(values.solver)});
  return session.once(ResultFile(session.out()), [&](ResultFile& file) -> std::optional<Made> {
    wave::write_solution(file, solution, sensors.angles, sensors.points);
    const double wavelength = 2 * std::numbers::pi / cluster.t_matrix.k;
    ResultGroup(file, scene_table).attribute("wavelength", wavelength);
    std::ostringstream plan;
    plan << places.size() << " copies of a cluster, " << solution.equations().unknowns()
         << " unknowns: " << solution.method();
    std::printf("%s\nresidual %.1e\n", plan.str().c_str(), solution.diagnosis().residual);
    return Made{plan.str(), 1};
  });
}

/// Where scatterers of a file lie: the corners of the box around them.
std::vector<Vec2> corners_around(const Placement& placement) {
  Vec2 low = placement.front().position, high = low;
  for (const auto& [x, scatterer] : placement) {
    low = {std::min(low.x, x.x), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.z, x.z)};
  }
  return {low, {high.x, low.z}, {low.x, high.z}, high};
}

/// Point scatterers where the index varies.
int solve_graded(const Subcommand& command, const SolveKeys& values, const Session& session) {
  const Keys& keys = command.keys();
  const SceneSpec& spec = values.spec;
  const double k = 2 * std::numbers::pi / spec.wavelength;
  Placement placement;
  std::optional<wave::GradedFields> fields;
  Lights lights;
  std::vector<View> views;
  if (is_placement_rule(spec)) {
    const Scene scene = make_scene(keys, spec);
    placement = drawn_placement(spec, scene, session.seed());
    fields = wave::graded_fields(scene);
    lights = scene.request.lights;
    views = scene.request.views;
  } else {
    const auto field = index_field(keys, spec);
    const auto sources = read_points(keys.required(spec.near_sources)),
               sensors = read_points(keys.required(spec.near_sensors));
    keys.read(spec.wavelength);
    placement = placement_of_file(keys, spec, values.run);
    if (placement.empty() || placement.front().scatterer.is_disk())
      throw InputError("index_field", spec.index_field, "is of points, one at the least");
    fields.emplace(*field, k, sources, sensors, corners_around(placement));
    for (const Vec2 source : sources) lights.push_back(point_source(source));
    for (const Vec2 sensor : sensors) views.push_back(near_sensor(sensor));
  }
  for (const View& view : views) require_outside(placement, view.point);
  if (!command.settle()) return ExitStatus::done;
  blas_single_thread();  // says now what it lacks
  return session.once(ResultFile(session.out()), [&](ResultFile& file) -> std::optional<Made> {
    write_light_axis(file, lights);
    write_view_axis(file, views);
    ResultGroup(file, wave::graded_table).put("near_source_field", fields->of(placement));
    wave::write_placement(file, placement);
    ResultGroup(file, scene_table).attribute("wavelength", spec.wavelength);
    const std::string plan = std::to_string(placement.size()) +
                             " points in a graded medium, coupled by its own Green function";
    std::printf("%s\n", plan.c_str());
    return Made{plan, 1};
  });
}

Made spectrum_made(const wave::Spectrum& spectrum, const WavelengthList& wavelengths,
                   const Placement& placement) {
  std::ostringstream plan;
  plan << placement.size() << " scatterers at " << wavelengths.values.size()
       << " wavelengths, up to " << spectrum.unknowns() << " unknowns: ";
  std::printf("%sresidual at most %.1e\n", plan.str().c_str(), spectrum.residual());
  plan << "one solution after the other";
  return {plan.str(), 1};
}

}  // namespace

int solve(const Arguments& arguments) {
  SolveKeys values;
  Subcommand command("solve", "Exact fields of one placement of scatterers");
  Keys& keys = command.keys();
  add_keys(keys, values);
  if (!command.parse(arguments)) return ExitStatus::done;

  const Session session(command.text(), keys, values.run, command.only_prints());
  const SceneSpec& spec = values.spec;
  if (keys.read(spec.index_field) != "homogeneous") return solve_graded(command, values, session);
  if (!spec.near_sources.empty())
    throw InputError("near_sources", spec.near_sources, "are of media with an index_field");
  const Sensors sensors = sensors_of(keys, spec);
  if (!values.cluster.empty()) return solve_clusters(command, values, session, sensors);
  const auto wavelengths = wavelength_list(keys, values.spectrum);
  std::optional<wave::MapGrid> grid;
  if (wavelengths.values.empty()) grid = map_grid(keys, values.map, keys.read(spec.wavelength));
  if (wavelengths.values.empty()) keys.read(values.t_matrix_gap);
  keys.read(values.tolerance);
  keys.read(values.solver);
  std::optional<Scene> scene;
  if (is_placement_rule(spec)) scene = make_scene(keys, spec);
  const Placement placement = scene ? drawn_placement(spec, *scene, session.seed())
                                    : placement_of_file(keys, spec, values.run);
  for (const Vec2& sensor : sensors.points) require_outside(placement, sensor);
  if (wavelengths.index) require_index_from_table(spec, placement);
  if (!command.settle()) return ExitStatus::done;
  blas_single_thread();  // says now what it lacks
  const auto write_scene = [&](ResultFile& file) {
    if (scene)
      write_medium(file, *scene);
    else
      ResultGroup(file, scene_table).attribute("wavelength", spec.wavelength);
  };
  if (!wavelengths.values.empty()) {
    catch_interrupts();
    return session.once(ResultFile(session.out()), [&](ResultFile& file) -> std::optional<Made> {
      const auto found = spectrum(values, placement, wavelengths, sensors);
      if (!found) return std::nullopt;
      found->write(file);
      write_scene(file);
      return spectrum_made(*found, wavelengths, placement);
    });
  }
  const auto solution = solved(values, placement, spec.wavelength, grid, sensors.points);
  std::optional<wave::KeptCluster> cluster;
  if (values.t_matrix_gap)
    cluster = wave::kept_cluster(placement, 2 * std::numbers::pi / spec.wavelength,
                                 *values.t_matrix_gap, values.tolerance);
  if (grid) catch_interrupts();  // which must not leave the file that a map is written to
  ResultFile result(session.out(), grid ? ResultFile::Storage::disk : ResultFile::Storage::memory);
  return session.once(std::move(result), [&](ResultFile& file) -> std::optional<Made> {
    wave::write_solution(file, solution, sensors.angles, sensors.points);
    std::string map_method;
    if (grid) {
      const auto method = wave::write_map(file, solution, *grid, values.tolerance);
      if (!method) return std::nullopt;
      map_method = *method;
    }
    if (cluster) wave::write_cluster(file, *cluster);
    write_scene(file);
    print_summary(solution);
    if (grid) std::printf("%s\n", map_method.c_str());
    return Made{plan_of(solution, map_method), 1};
  });
}

}  // namespace flatspeckle::apps
