#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "apps/command/experiment.h"
#include "apps/results/estimation.h"
#include "apps/results/extras.h"
#include "apps/results/view_power.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/address_space.h"
#include "core/numbers/blas.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/paths/speckle/field_datasets.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::apps {

namespace {

/// Values of the keys of the subcommand `field`.
struct FieldKeys {
  SceneSpec spec;
  std::int64_t fields = 16;
  std::optional<std::int64_t> paths_per_field;
  double target_error = mc::FieldDemand().covariance_error;
  std::string method = "auto";
  double camera_tolerance = mc::FieldDemand().camera_tolerance;
  std::optional<double> camera_focus, camera_width;
  mc::DynamicsValues moving;
  std::vector<std::string> frequency_shifts;
  std::optional<double> length_unit;
  MethodSettings estimation;
};

/// Adds the keys of changes between the fields of a realization.
void add_change_keys(Keys& keys, FieldKeys& values) {
  add_length_unit_key(keys, values.length_unit);
  keys.group("Changes");
  keys.add("delays", values.moving.delays,
           "Times of the fields of a realization, at which the scatterers have moved; like those "
           "of covariance");
  mc::add_motion_keys(keys, values.moving);
  keys.add("frequency_shifts", values.frequency_shifts,
           "Frequencies of the fields of a realization, as changes relative to the frequency");
}

void add_field_keys(Keys& keys, FieldKeys& values) {
  add_scatterer_keys(keys, values.spec);
  add_bulk_keys(keys, values.spec);
  add_medium_keys(keys, values.spec);
  add_profile_keys(keys, values.spec);
  add_index_keys(keys, values.spec);
  add_structure_key(keys, values.spec);
  add_view_keys(keys, values.spec);
  add_light_keys(keys, values.spec);
  add_space_keys(keys, values.spec);
  keys.add("tilts", values.spec.tilts,
           "Rotations of the light; fields are computed under each rotation, in the same views")
      .angle();
  keys.group("Fields");
  keys.add("fields", values.fields, "Number of realizations, at least 2 for error estimates")
      .from(2, std::numeric_limits<double>::infinity());
  keys.add("method", values.method,
           "paths: separate light paths for each field; covariance: Cholesky factor of the "
           "estimated covariance; auto: the cheaper one")
      .one_of({"auto", "paths", "covariance"});
  keys.add("paths_per_field", values.paths_per_field,
           "Number of light paths of each field (default: the number for which the excess kurtosis "
           "is 0.01)")
      .positive();
  keys.add("target_error", values.target_error,
           "Relative error of the covariance from which fields are drawn")
      .between(0, 1);
  keys.add(
          "tolerance", values.camera_tolerance,
          "Largest relative rms error of the fast sums over the pixels of a camera; with a smaller "
          "error than they reach, every pixel is summed directly")
      .between(0, 1)
      .only_of("a camera (camera_pixels)");
  keys.add("camera_focus", values.camera_focus,
           "Depth z of the plane that the camera images by a lens with a round pupil of radius "
           "camera_aperture: its fields are those in this plane, without the waves that miss the "
           "pupil (default: far views)")
      .unit("length")
      .only_of("a camera (camera_pixels)");
  keys.add("camera_width", values.camera_width,
           "Side of the square that a lens images (default: the larger of width and height)")
      .positive()
      .unit("length")
      .only_of("a lens (camera_focus)");
  add_mc_keys(keys, values.estimation);
  add_change_keys(keys, values);
}

/// Returns the changes between the fields of a realization.
mc::FieldChanges changes_of(const Keys& keys, const FieldKeys& values) {
  const SceneSpec& spec = values.spec;
  keys.read(values.length_unit);
  const mc::Dynamics dynamics = mc::make_dynamics(keys, values.moving, spec, length_unit(keys));
  const mc::FrequencyShifts shifts = frequency_shifts(keys, values.frequency_shifts, spec);
  return {dynamics.delays, dynamics.motion, shifts.relative, dynamics.diffusion.has_value()};
}

mc::FieldDemand demand_of(const Keys& keys, const FieldKeys& values) {
  using enum mc::FieldMethod;
  const std::string& method = keys.read(values.method);
  mc::FieldDemand demand{.method = method == "paths"        ? paths
                                   : method == "covariance" ? covariance
                                                            : automatic};
  demand.fields = static_cast<std::uint64_t>(keys.read(values.fields));
  if (demand.method != covariance)
    if (const auto& paths_each = keys.read(values.paths_per_field))
      demand.paths_per_field = static_cast<std::uint64_t>(*paths_each);
  if (values.spec.camera_pixels && demand.method != covariance)
    demand.camera_tolerance = keys.read(values.camera_tolerance);
  if (demand.method != paths) demand.covariance_error = keys.read(values.target_error);
  demand.changes = changes_of(keys, values);
  if (values.spec.dimension == 3 && values.spec.camera_pixels && keys.read(values.camera_focus))
    demand.image = {*values.camera_focus, keys.read(values.camera_width).value_or(0)};
  if (demand.requires_paths() && demand.method == covariance)
    throw InputError("method", method,
                     "does not support delays, frequency_shifts and camera_focus: use method = "
                     "paths");
  return demand;
}

void check_changes(const Scene& scene, const FieldKeys& values, const mc::FieldChanges& changes) {
  constexpr double largest_shift = 0.1;
  if (changes.none()) return;
  const int lists = !values.spec.tilts.empty() + !changes.delays.empty() + !changes.shifts.empty();
  if (lists > 1) throw InputError("tilts, delays, frequency_shifts: give only one of them");
  mc::check_delays(scene, changes.delays, changes.motion);
  for (const double shift : changes.shifts)
    if (std::abs(shift) > largest_shift)
      throw InputError("frequency_shifts", shift, "must be between -0.1 and 0.1");
  if (scene.request.lights.size() > 1)
    throw InputError("delays, frequency_shifts: require one light");
  if (has_near_endpoints(scene.request) || scene.faces || scene.index)
    throw InputError("delays, frequency_shifts: require plane waves, far views, and no refraction");
}

/// Makes the camera of the scene the pupil of the lens that images a plane.
void look_through_lens(mc::LensPlane& image, Scene& scene) {
  const FarCamera lens = scene.request.camera.value();
  const Domain& box = scene.domain;
  image.pixels = lens.pixels;
  if (image.width == 0) image.width = std::max(box.width, box.height);
  const CovarianceRequest given = scene.request;
  const FarCamera pupil = mc::pupil_of(lens, image, box, scene.wavelength);
  scene.request = mc::field_request(given.lights, pupil.views());
  scene.request.camera = pupil;
  scene.request.tilts = given.tilts;
  scene.request.tilt_azimuth = given.tilt_azimuth;
  scene.request.tilt_q = given.tilt_q;
}

Scene field_scene(const Keys& keys, const SceneSpec& spec) {
  if (spec.domain == "slab")
    throw InputError("domain", spec.domain,
                     "must be box: the speckles of an infinite slab are infinitely fine");
  const auto& tilts = keys.read(spec.tilts);
  const bool turned = spec.dimension == 3 && !tilts.empty();
  keys.read(spec.dimension);
  const double turn = turned ? keys.read(spec.tilt_azimuth).value_or(0) : 0;
  Scene scene = with_dimension(make_scene(keys, spec), spec);
  const CovarianceRequest given = scene.request;
  Lights lights = given.lights;
  if (!tilts.empty()) {
    if (lights.size() != 1) throw InputError("tilts: require exactly one angle in light_angles");
    if (lights.front().kind == Light::Kind::point)
      throw InputError("tilts, near_sources: give only one of them");
    lights = tilted_lights(given.lights.front(), tilts, given.lights.front().azimuth + turn);
  }
  scene.request = mc::field_request(lights, given.views);
  scene.request.camera = given.camera;
  scene.request.tilts = tilts;
  scene.request.tilt_azimuth = given.lights.front().azimuth + turn;
  scene.request.tilt_q =
      tilt_momenta(scene.k, given.lights.front(), tilts, scene.request.tilt_azimuth);
  return scene;
}

void check_memory(const Scene& scene, const mc::FieldDemand& demand) {
  constexpr double sums = 100;  // complex numbers per channel that are needed besides the fields
  const double pixels = demand.image ? std::pow(static_cast<double>(demand.image->pixels), 2)
                                     : static_cast<double>(scene.request.views.size()),
               channels = pixels *
                          static_cast<double>(scene.request.lights.size() * demand.changes.count());
  const double bytes = sizeof(Complex) * channels * (static_cast<double>(demand.fields) + sums);
  const double memory = usable_memory();
  if (bytes > 0.8 * memory)
    throw InputError("fields", demand.fields,
                     number_text(channels) + " channels need " + std::to_string(bytes / 1e9) +
                         " GB of memory; reduce fields, views or tilts; available in GB: " +
                         std::to_string(memory / 1e9));
  if (demand.method != mc::FieldMethod::covariance) return;
  // throws InputError if the covariances do not fit into memory
  full_request(scene.request.lights, scene.request.views);
  blas_single_thread();  // throws InputError if memory for BLAS is missing
}

/// Prints statistics of all drawn fields, and the values expected for a circular Gaussian field.
void print_summary(const mc::DrawnFields& drawn, const mc::FieldSummary& summary, bool on_camera) {
  const auto& [contrast, circularity, found, grain] = summary;
  const Complex pseudo = circularity.value[0];
  std::printf("contrast %.4f +- %.2g, <u u> / <I> %.2g%+.2gi +- %.2g (Gaussian: 1 and 0)\n",
              contrast.value[0].real(), contrast.error[0], pseudo.real(), pseudo.imag(),
              circularity.error[0]);
  const bool by_paths = drawn.plan.method == mc::FieldMethod::paths;
  const double expected = by_paths ? std::sqrt(1 + drawn.plan.excess) : 1;
  if (by_paths && contrast.value[0].real() > expected + 4 * contrast.error[0])
    std::fprintf(stderr,
                 "note: the contrast is too high: a few strong paths dominate the fields; raise "
                 "paths_per_field, which is %llu\n",
                 static_cast<unsigned long long>(drawn.plan.paths_per_field));
  if (grain)
    std::printf(
        "grain width %.4g +- %.2g (full width at half maximum of the intensity autocorrelation)\n",
        grain->value[0].real(), grain->error[0]);
  else if (on_camera || !found.value.empty())
    std::puts(
        "grain width not resolved: the autocorrelation falls to half within one step of the views, "
        "or not at all");
  else
    std::puts("no grain width: it requires view_angles in equal steps of their sine");
  const Estimate& siegert = drawn.siegert;
  if (found.value.empty() || siegert.value.empty()) return;
  const double excess = by_paths ? drawn.plan.excess : 0;
  double deviation = 0;
  for (std::size_t d = 0; d < found.value.size(); ++d) {
    const double beyond = std::abs(found.value[d] - siegert.value[d]) - excess;
    const double error = std::hypot(found.error[d], siegert.error[d]);
    if (beyond > 0 && error > 0) deviation = std::max(deviation, beyond / error);
  }
  std::printf(
      "autocorrelation of the intensity: agrees with the Siegert relation within %.1f standard "
      "errors%s\n",
      deviation, by_paths ? " and the excess kurtosis" : "");
}

class FieldExperiment : public OneShot {
 public:
  void add_keys(Keys& keys) override {
    add_field_keys(keys, values_);
    add_seed_key(keys, run_, "Random seed; field n of a seed is always the same");
    add_thread_key(keys, run_);
    add_output_key(keys, run_);
  }

  void read(const Keys& keys) override {
    demand_ = demand_of(keys, values_);
    settings_ = {reversed_paths(keys, values_.estimation), seed(), threads()};
    scene_ = field_scene(keys, values_.spec);
    check_changes(*scene_, values_, demand_.changes);
    if (demand_.image) look_through_lens(*demand_.image, *scene_);
    refuse_absurd(values_.estimation, Neglected(*scene_));
    check_memory(*scene_, demand_);
  }

 private:
  ResultFile::Storage storage() const override { return ResultFile::Storage::disk; }

  Made make(ResultFile& file, bool prints) const override {
    const auto print_plan = [&](const mc::DrawingPlan& chosen) {
      if (!prints) return;
      std::printf("%s\n", chosen.describe().c_str());
      std::fflush(stdout);
    };
    const auto drawn = mc::draw_fields(*scene_, demand_, settings_, print_plan);
    write_medium(file, *scene_);
    const auto summary = mc::write_fields(file, *scene_, drawn);
    const double paths = drawn.plan.method == mc::FieldMethod::covariance
                             ? static_cast<double>(drawn.plan.covariance_paths)
                             : static_cast<double>(drawn.plan.paths_per_field * demand_.fields);
    check_power(file, "", *scene_, {"mc", paths, 0, seed()});
    if (prints) print_summary(drawn, summary, scene_->request.camera.has_value());
    const bool is_dark =
        scene_->medium.mu_s > 0 &&
        std::ranges::all_of(drawn.intensity.value, [](Complex value) { return value == 0.0; });
    if (is_dark)
      std::fputs(
          "note: no light path has reached the views: all fields are 0; increase paths_per_field\n",
          stderr);
    return Made{
        "mc: " +
            mc::plan_of_fields(*scene_, settings_.reversed, demand_.image.has_value()).describe() +
            "; " + drawn.plan.describe(),
        static_cast<double>(demand_.fields),
        is_dark ? ExitStatus::error_not_reached : ExitStatus::done};
  }

  FieldKeys values_;
  mc::FieldDemand demand_;
  mc::DrawingSettings settings_;
  std::optional<Scene> scene_;
};

}  // namespace

std::unique_ptr<Experiment> field_experiment() {
  return std::make_unique<FieldExperiment>();
}

}  // namespace flatspeckle::apps
