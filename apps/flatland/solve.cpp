#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <numbers>
#include <optional>
#include <sstream>
#include <vector>

#include "apps/command/experiment.h"
#include "apps/flatland/map_settings.h"
#include "apps/flatland/own_places.h"
#include "apps/flatland/solve_keys.h"
#include "apps/flatland/solve_places.h"
#include "apps/flatland/solver_keys.h"
#include "apps/flatland/space_solve.h"
#include "apps/results/wavelengths.h"
#include "core/error.h"
#include "core/keys/keys.h"
#include "core/keys/number_text.h"
#include "core/numbers/blas.h"
#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/progress.h"
#include "core/run/stopwatch.h"
#include "flatland/scene/periodic_placement.h"
#include "flatland/scene/scene.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/graded/graded_fields.h"
#include "wave_solver/layered/layer_fields.h"
#include "wave_solver/maps/field_map.h"
#include "wave_solver/periodic/cell_map.h"
#include "wave_solver/periodic/matrix_job.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::apps {

namespace {

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

/// Directions and positions at which the field is computed: angles of far-field views, and near
/// sensors.
struct Sensors {
  std::vector<double> angles;
  std::vector<Vec> points;
};

Sensors sensors_of(const Keys& keys, const SceneSpec& spec) {
  Sensors sensors;
  keys.read(spec.light_angles);
  keys.read(spec.view_angles);
  if (keys.read(spec.near_sensors).empty() || keys.given(spec.view_angles))
    sensors.angles = spec.view_angles;
  if (!spec.near_sensors.empty()) sensors.points = read_points("near_sensors", spec.near_sensors);
  return sensors;
}

wave::WaveSolution solved(const SolveKeys& values, const Placement& placement, double wavelength,
                          const std::optional<wave::MapGrid>& grid,
                          const std::vector<Vec>& sensors) {
  wave::SolveOptions options{.tolerance = values.tolerance, .sensors = sensors};
  options.method = solver_method(values.solver);
  if (grid)
    for (const Vec& point : wave::map_sensors(*grid, placement)) options.sensors.push_back(point);
  return wave::solve(placement, 2 * std::numbers::pi / wavelength, values.spec.light_angles,
                     options);
}

/// Solves for all wavelengths, one after the other, and returns the fields as a spectrum.
wave::Spectrum spectrum(const SolveKeys& values, const Placement& placement,
                        const WavelengthList& wavelengths, const Sensors& sensors, bool prints) {
  wave::Spectrum spectrum(sensors.angles, sensors.points);
  Progress progress(prints ? "solve" : "", "wavelengths");
  const Stopwatch watch;
  Progress::Figures figures;
  for (const double wavelength : wavelengths.values) {
    spectrum.add(wavelength, solved(values, wavelengths.at(wavelength, placement), wavelength, {},
                                    sensors.points));
    stop_if_interrupted();
    figures.samples += 1;
    figures.rate = figures.samples / watch.seconds();
    figures.seconds_left =
        (static_cast<double>(wavelengths.values.size()) - figures.samples) / figures.rate;
    progress.update(watch.seconds(), figures);
  }
  progress.finish(watch.seconds(), figures);
  return spectrum;
}

std::string plan_of(const wave::Spectrum& spectrum, const WavelengthList& wavelengths,
                    const Placement& placement) {
  std::ostringstream plan;
  plan << placement.size() << " scatterers at " << wavelengths.values.size()
       << " wavelengths, up to " << spectrum.unknowns() << " unknowns: ";
  return plan.str();
}

/// Returns the four corners of the smallest box that contains all scatterers.
std::vector<Vec> corners_around(const Placement& placement) {
  const auto [low, high] = bounds_of(placement, &PlacedScatterer::position);
  return {low, {high.x, low.z}, {low.x, high.z}, high};
}

/// Solver for point scatterers in a medium of varying index, with its lights and views.
struct GradedWork {
  std::optional<wave::GradedFields> fields;
  CovarianceRequest request;
};

class SolveExperiment : public OneShot {
 public:
  void add_keys(Keys& keys) override {
    add_solve_keys(keys, values_);
    add_thread_key(keys, run_);
    add_seed_key(keys, run_, "Random seed of a drawn placement");
    add_output_key(keys, run_);
  }

  void read(const Keys& keys) override {
    keys.read(run_.seed);
    // the seed has no effect, because the placement is not random
    if (has_own_places(values_.spec)) keys.disregard(run_.seed);
    if (keys.read(values_.spec.dimension) == 3) return read_space(keys);
    if (keys.read(values_.spec.index_field) != "homogeneous") return read_graded(keys);
    if (keys.read(values_.spec.medium_index)) return read_layered(keys);
    keys.read(values_.tolerance);
    keys.read(values_.solver);
    if (keys.read(values_.period)) return read_periodic(keys);
    if (!values_.spec.near_sources.empty())
      throw InputError(
          "near_sources", values_.spec.near_sources,
          "requires an index_field or dimension = 3 (covariance --method wave accepts near_sources "
          "without them)");
    if (values_.spec.beam_waist && !has_own_places(values_.spec))
      throw InputError(
          "beam_waist", *values_.spec.beam_waist,
          "requires dimension = 3 (covariance --method wave accepts beams without it)");
    sensors_ = sensors_of(keys, values_.spec);
    if (values_.cluster.empty())
      read_placement_and_work(keys);
    else
      read_cluster(keys);
  }

 private:
  /// Reads a cluster of scatterers, and the positions at which copies of the cluster are placed.
  void read_cluster(const Keys& keys) {
    if (!has_own_places(values_.spec))
      throw InputError("placement", values_.spec.placement.value_or("none"),
                       "must be a CSV file with columns x, z [, angle] of the cluster's copies");
    places_ = wave::read_places(*keys.read(values_.spec.placement));
    cluster_ = wave::read_cluster(keys.read(values_.cluster));
    if (values_.tolerance < cluster_->tolerance)
      throw InputError(
          "tolerance", values_.tolerance,
          "must be at least the tolerance of the cluster, " + number_text(cluster_->tolerance));
  }

  void read_placement_and_work(const Keys& keys) {
    const SceneSpec& spec = values_.spec;
    wavelengths_ = wavelength_list(keys, values_.spectrum);
    if (wavelengths_->values.empty()) {
      grid_ = map_grid(keys, values_.map, keys.read(spec.wavelength));
      keys.read(values_.t_matrix_gap);
    }
    if (!has_own_places(spec)) scene_ = make_scene(keys, spec);
    placement_ = scene_ ? drawn_placement(spec, *scene_, seed()) : placement_of_file(keys, spec);
    const double shortest = wavelengths_->values.empty()
                                ? keys.read(spec.wavelength)
                                : *std::ranges::min_element(wavelengths_->values);
    for (const Vec& sensor : sensors_.points) {
      require_outside(placement_, sensor);
      require_phase("near_sensors", sensor, 2 * std::numbers::pi / shortest);
    }
    if (wavelengths_->index) require_index_from_table(spec, placement_);
  }

  /// Throws InputError for keys that have no effect with a period.
  void refuse_keys_of_one_light(const Keys& keys) const {
    const SceneSpec& spec = values_.spec;
    const auto refuse = [&](const auto& member, const char* why) {
      if (keys.given(member)) throw InputError(keys.name(member) + ": not with period" + why);
    };
    const char* const channels = ", whose light and views are the channels: leave it out";
    refuse(spec.light_angles, channels);
    refuse(spec.view_angles, channels);
    refuse(spec.near_sensors, channels);
    refuse(spec.near_sources, channels);
    refuse(spec.beam_waist, channels);
    refuse(values_.spectrum.wavelengths, "; use sweep --of solve --vary wavelength=...");
  }

  void read_map_lights(const Keys& keys) {
    const double k = 2 * std::numbers::pi / values_.spec.wavelength;
    const auto channels = wave::channels_of(k, {*values_.period, values_.period_phase}).size();
    lights_ = wave::cell_lights(keys.read(values_.map_eigenchannels), keys.read(values_.map_lights),
                                channels);
  }

  void read_periodic(const Keys& keys) {
    const SceneSpec& spec = values_.spec;
    refuse_keys_of_one_light(keys);
    keys.read(values_.period_phase);
    grid_ = map_grid(keys, values_.map, keys.read(spec.wavelength));
    if (grid_) read_map_lights(keys);
    if (has_own_places(spec)) {
      placement_ = placement_of_file(keys, spec);
      return;
    }
    scene_ = make_scene(keys, spec);
    keys.disregard(spec.light_angles);
    keys.disregard(spec.view_angles);
    if (scene_->domain.kind != Domain::Kind::box || scene_->domain.width != *values_.period)
      throw InputError("period", *values_.period,
                       "must be the width of the box in which the placement is drawn");
    if (!scene_->medium.has_scatterers) refuse_bulk(spec);
    RandomStream random(seed(), static_cast<std::uint64_t>(Stream::placement), 0);
    placement_ = draw_periodic_placement(*scene_, random);
  }

  void read_space(const Keys& keys) {
    keys.read(values_.tolerance);
    keys.read(values_.solver);
    SceneSpec& spec = values_.spec;
    space_ = space_request(keys, spec);
    grid_ = map_grid(keys, values_.map, keys.read(spec.wavelength));
    space_->map = grid_;
    if (grid_) space_->map_y = keys.read(values_.map.map_y).value_or(0);
    if (!has_own_places(spec)) scene_ = make_scene(keys, spec);
    placement_ = scene_ ? drawn_placement(spec, *scene_, seed()) : placement_of_file(keys, spec);
    for (const View& sensor : space_->near_sensors) require_outside(placement_, sensor.point);
  }

  void read_graded(const Keys& keys) {
    graded_.emplace();
    if (!has_own_places(values_.spec))
      read_drawn_graded(keys);
    else
      read_graded_file(keys);
    for (const View& view : graded_->request.views) require_outside(placement_, view.point);
  }
  void read_drawn_graded(const Keys& keys) {
    const Scene scene = make_scene(keys, values_.spec);
    placement_ = drawn_placement(values_.spec, scene, seed());
    graded_->fields = wave::graded_fields(scene);
    graded_->request = scene.request;
  }
  void read_graded_file(const Keys& keys) {
    const SceneSpec& spec = values_.spec;
    const auto field = index_field(keys, spec);
    const auto sources = read_points("near_sources", keys.required(spec.near_sources)),
               sensors = read_points("near_sensors", keys.required(spec.near_sensors));
    const double k = 2 * std::numbers::pi / keys.read(spec.wavelength);
    placement_ = placement_of_file(keys, spec);
    if (placement_.empty() || placement_.front().scatterer.is_disk())
      throw InputError("index_field", spec.index_field, "requires at least one point scatterer");
    graded_->fields.emplace(*field, k, sources, sensors, corners_around(placement_));
    graded_->request =
        intensity_request(column(sources, point_source), column(sensors, near_sensor));
  }

  void read_layered(const Keys& keys) {
    const SceneSpec& spec = values_.spec;
    if (has_own_places(spec)) {
      keys.read(spec.wavelength);
      keys.required(spec.depth);
      keys.read(spec.light_angles);
      keys.read(spec.view_angles);
      const auto faces = make_faces(keys, spec);
      placement_ = placement_of_file(keys, spec);
      scene_ = layer_around(*faces, spec, placement_);
    } else {
      scene_ = make_scene(keys, spec);
      placement_ = drawn_placement(spec, *scene_, seed());
    }
    layered_ = wave::layer_fields(*scene_);
  }

  void note() const override {
    if (cluster_) return;
    if (placement_.empty())
      std::cerr << "note: the placement contains no scatterers: all scattered fields are 0\n";
    note_thin_index(placement_);
  }

  ResultFile::Storage storage() const override {
    return grid_ ? ResultFile::Storage::disk : ResultFile::Storage::memory;
  }

  Made make(ResultFile& file, bool prints) const override {
    blas_single_thread();  // called here so that missing memory is reported before the slow work
    if (space_) return make_space(file, prints);
    if (graded_) return make_graded(file, prints);
    if (layered_) return make_layered(file, prints);
    if (cluster_) return make_clusters(file, prints);
    if (values_.period) return make_periodic(file, prints);
    return wavelengths_->values.empty() ? make_fields(file, prints) : make_spectrum(file, prints);
  }

  Made make_space(ResultFile& file, bool prints) const {
    wave::SolveOptions options{.tolerance = values_.tolerance, .sensors = {}};
    options.method = solver_method(values_.solver);
    const std::string plan = write_space_solution(
        file, placement_, 2 * std::numbers::pi / values_.spec.wavelength, *space_, options, prints);
    write_scene(file);
    return Made{plan, 1};
  }

  Made make_graded(ResultFile& file, bool prints) const {
    ResultGroup(file, scene_table).attribute("wavelength", values_.spec.wavelength);
    return made_points(file, graded_->request, prints, "graded medium", [&] {
      ResultGroup(file, wave::graded_table)
          .put("near_source_field", graded_->fields->of(placement_));
    });
  }

  Made make_layered(ResultFile& file, bool prints) const {
    has_own_places(values_.spec) ? write_domain(file, *scene_) : write_medium(file, *scene_);
    return made_points(file, scene_->request, prints, "layer with reflecting faces", [&] {
      ResultGroup(file, wave::solution_table).put("far_field", layered_->of(placement_));
    });
  }

  /// Writes the axes, the fields and the positions of points in a medium with a Green function.
  template <typename PutFields>
  Made made_points(ResultFile& file, const CovarianceRequest& request, bool prints,
                   const std::string& medium, const PutFields& put_fields) const {
    write_light_axis(file, request.lights);
    write_view_axis(file, request.views);
    put_fields();
    wave::write_placement(file, placement_);
    const std::string plan = std::to_string(placement_.size()) + " points in a " + medium +
                             ", coupled by its Green function";
    if (prints) std::printf("%s\n", plan.c_str());
    return Made{plan, 1};
  }

  Made make_clusters(ResultFile& file, bool prints) const {
    const wave::ClusterSolution solution(
        cluster_->t_matrix, places_, values_.spec.light_angles,
        {values_.tolerance, sensors_.points, true, solver_method(values_.solver)});
    wave::write_solution(file, solution, sensors_.angles, sensors_.points);
    const double wavelength = 2 * std::numbers::pi / cluster_->t_matrix.k;
    ResultGroup(file, scene_table).attribute("wavelength", wavelength);
    std::ostringstream plan;
    plan << places_.size() << " copies of a cluster, " << solution.equations().unknowns()
         << " unknowns: " << solution.method();
    if (prints)
      std::printf("%s\nresidual %.1e\n", plan.str().c_str(), solution.diagnosis().residual);
    return Made{plan.str(), 1};
  }

  Made make_periodic(ResultFile& file, bool prints) const {
    wave::SolveOptions options{.tolerance = values_.tolerance, .sensors = {}};
    options.method = solver_method(values_.solver);
    const double k = 2 * std::numbers::pi / values_.spec.wavelength;
    const Placement placement = wave::in_one_cell(placement_, *values_.period);
    Rectangle region = wave::region_of(placement);
    if (grid_) region = region.united({grid_->low, grid_->high});
    const auto images = wave::cell_images(k, {*values_.period, values_.period_phase}, region,
                                          wave::image_tolerance(options.tolerance));
    auto found = wave::scattering_matrix_in_region(placement, k, images, options);
    wave::compare_unit_cells(found, placement, k, images.period, options);
    wave::write_scattering_matrix(file, found);
    wave::write_placement(file, placement_);
    write_scene(file);
    std::string map_method;
    if (grid_)
      map_method =
          wave::write_cell_map(file, placement, k, images, found, lights_, options, *grid_);
    std::ostringstream plan;
    plan << placement_.size() << " scatterers a period, " << found.channels.size()
         << " channels on each side, " << found.unknowns << " unknowns: " << found.method
         << (grid_ ? "; " : "") << map_method;
    if (prints)
      std::printf("%s\nerror of power %.1e, %s\n", plan.str().c_str(), found.power.off,
                  error_of_reciprocity(found.reciprocity).c_str());
    return Made{plan.str(), 1};
  }

  Made make_spectrum(ResultFile& file, bool prints) const {
    const auto found = spectrum(values_, placement_, *wavelengths_, sensors_, prints);
    found.write(file);
    write_scene(file);
    const std::string plan = plan_of(found, *wavelengths_, placement_);
    if (prints) std::printf("%sresidual at most %.1e\n", plan.c_str(), found.residual());
    return Made{plan + "one solution after the other", 1};
  }

  Made make_fields(ResultFile& file, bool prints) const {
    const double wavelength = values_.spec.wavelength;
    const auto solution = solved(values_, placement_, wavelength, grid_, sensors_.points);
    std::optional<wave::KeptCluster> cluster;
    if (values_.t_matrix_gap)
      cluster = wave::kept_cluster(placement_, 2 * std::numbers::pi / wavelength,
                                   *values_.t_matrix_gap, values_.tolerance);
    wave::write_solution(file, solution, sensors_.angles, sensors_.points);
    std::string map_method;
    if (grid_)
      map_method = wave::write_map(file, wave::mapped(solution), *grid_, values_.tolerance);
    if (cluster) wave::write_cluster(file, *cluster);
    write_scene(file);
    if (prints) print_summary(solution);
    if (prints && grid_) std::printf("%s\n", map_method.c_str());
    return Made{plan_of(solution, map_method), 1};
  }

  void write_scene(ResultFile& file) const {
    if (scene_) return write_medium(file, *scene_);
    const ResultGroup root(file, scene_table);
    if (space_) root.attribute("dimension", std::uint64_t{3});
    root.attribute("wavelength", values_.spec.wavelength);
  }

  SolveKeys values_;
  Sensors sensors_;
  std::optional<WavelengthList> wavelengths_;
  std::optional<wave::MapGrid> grid_;
  wave::CellLights lights_;
  std::optional<Scene> scene_;
  Placement placement_;
  std::optional<wave::KeptCluster> cluster_;
  std::vector<wave::ClusterPlace> places_;
  std::optional<SpaceRequest> space_;
  std::optional<GradedWork> graded_;
  std::optional<wave::LayerFields> layered_;
};

}  // namespace

std::unique_ptr<Experiment> solve_experiment() {
  return std::make_unique<SolveExperiment>();
}

}  // namespace flatspeckle::apps
