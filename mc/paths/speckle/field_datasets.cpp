#include "mc/paths/speckle/field_datasets.h"

#include <algorithm>
#include <cmath>

#include "core/numbers/address_space.h"
#include "core/numbers/blas.h"
#include "core/result/result_group.h"
#include "core/run/runner.h"
#include "flatland/request/request.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/camera_resolution.h"
#include "mc/paths/speckle/field_statistics.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// Limits for Siegert's relation: the largest number of views, and the number of paths from which
/// the covariance is estimated. The squared relative error of that covariance, about 1e-3, biases
/// the autocorrelation.
constexpr std::size_t most_siegert_views = 512;
constexpr std::uint64_t siegert_paths = 20000;

/// Number of batches of a run for the covariance, and largest number of paths in a batch. Batches
/// are few and long, because the runs have a fixed length and every batch costs a pass over the
/// covariance.
constexpr std::uint64_t covariance_batches = 128, most_per_batch = 100000;

/// Returns the number of fields of a realization, and the number of views of each.
std::size_t fields_of(const Scene& scene, const DrawnFields& drawn) {
  return drawn.changes.count() * scene.request.lights.size();
}
std::size_t pixels_of(const Scene& scene, const DrawnFields& drawn) {
  return drawn.image ? drawn.image->pixels * drawn.image->pixels : scene.request.views.size();
}

/// Performs the runs of draw_fields() (survey, covariance, fields) one after another, and adds up
/// their times.
class FieldDrawing {
 public:
  FieldDrawing(const Scene& scene, const DrawingSettings& settings)
      : scene_(scene), settings_(settings), plan_(make_plan(scene, settings.reversed)) {}

  DrawnFields draw(const FieldDemand& demand,
                   const std::function<void(const DrawingPlan&)>& planned) {
    drawn_.changes = demand.changes;
    drawn_.image = demand.image;
    plan_ = plan_of_fields(scene_, settings_.reversed, demand.image.has_value());
    const bool camera = scene_.request.camera.has_value();
    if (camera) blas_single_thread();  // must come before threads request memory from BLAS
    const Scene surveyed = camera && !demand.image ? on_coarse_camera(scene_) : scene_;
    const RunState survey = run("survey", survey_job(surveyed, plan_, settings_.seed, demand.image),
                                demand.image ? image_survey_paths : survey_paths);
    drawn_.plan = make_field_plan(scene_, read_survey(survey.sums), demand);
    const bool by_paths = drawn_.plan.method == FieldMethod::paths;
    if (by_paths && camera) choose_camera(demand.camera_tolerance);
    planned(drawn_.plan);
    auto source = drawn_.plan.camera ? on_camera() : by_paths ? directly() : from_covariance();
    if (demand.image) {
      const FarCamera& pupil = scene_.request.camera.value();
      source = images_of(std::move(source), LensImage(pupil, *demand.image, scene_.k),
                         fields_of(scene_, drawn_), pupil.pixels * pupil.pixels);
    }
    const RunState fields = run("fields", field_job(source, demand.fields), demand.fields);
    if (by_paths) drawn_.intensity = jackknife(fields.sums, sample_mean);
    if (by_paths && siegert_applies()) covariance({scene_.request.lights.front()}, siegert_paths);
    return std::move(drawn_);
  }

 private:
  RunState run(const std::string& label, const BatchJob& job, std::uint64_t samples) {
    RunState state;
    const StopRule stop{samples, std::nullopt, std::nullopt};
    run_to_end(job, {stop, settings_.threads, label, {}}, state);
    drawn_.wall_s += state.wall_s;
    drawn_.cpu_s += state.cpu_s;
    return state;
  }

  /// Uses a CameraSum if it can be accurate enough and fits into memory.
  void choose_camera(double tolerance) {
    if (scene_.profile || scene_.faces || scene_.medium.mu_s == 0) return;
    const CameraResolution found = camera_resolution(scene_, plan_, settings_.seed, tolerance,
                                                     drawn_.changes.largest_moves(scene_));
    const double memory = usable_memory() / (2.0 * settings_.threads *
                                             static_cast<double>(fields_of(scene_, drawn_)));
    if (found.error > tolerance || found.bytes >= memory) return;
    drawn_.plan.camera = found;
    drawn_.plan.has_own_mean = plan_.reversed;
  }

  FieldDraw directly() const {
    return fields_by_paths(scene_, plan_, settings_.seed, drawn_.plan.paths_per_field,
                           drawn_.changes);
  }
  FieldDraw on_camera() const {
    return fields_on_camera(scene_, plan_, settings_.seed, drawn_.plan.paths_per_field,
                            *drawn_.plan.camera, drawn_.changes);
  }

  bool siegert_applies() const {
    return !scene_.request.camera && equal_step(scene_.request.views) &&
           scene_.request.views.size() <= most_siegert_views;
  }

  /// Estimates the covariance of all views under `lights`. The first one must be the first light of
  /// the scene.
  std::pair<FieldJob, RunState> covariance(const Lights& lights, std::uint64_t paths) {
    Scene scene = scene_;
    scene.request = full_request(lights, scene_.request.views);
    Plan plan = make_plan(scene, settings_.reversed);
    plan.paths_per_batch =
        std::min((paths + covariance_batches - 1) / covariance_batches, most_per_batch);
    FieldJob job = covariance_job(scene, plan, settings_.seed);
    job.batches.relative_error = BatchJob().relative_error;
    RunState state = run("covariance", job.batches, paths);
    if (siegert_applies())
      drawn_.siegert = siegert_relation(state.sums, job.covariance, scene_.request.views.size());
    return {job, std::move(state)};
  }

  FieldDraw from_covariance() {
    const auto [job, state] = covariance(scene_.request.lights, drawn_.plan.covariance_paths);
    const std::size_t channels = scene_.request.channels.size();
    drawn_.intensity = jackknife(
        state.sums, [&, estimator = job.covariance](double samples, std::span<const Complex> sums) {
          return diagonal(estimator(samples, sums), channels);
        });
    const auto lower = job.covariance(state.sums.total_samples(), state.sums.total());
    return fields_from_covariance(CovarianceFactor(channels, lower), settings_.seed);
  }

  /// Makes a job in which every batch draws a field. The sums are the intensities with which the
  /// fields are drawn (FieldDraw).
  BatchJob field_job(const FieldDraw& draw, std::uint64_t fields) {
    const std::size_t channels = fields_of(scene_, drawn_) * pixels_of(scene_, drawn_);
    drawn_.field.resize(fields * channels);
    BatchJob job;
    job.size = channels;
    job.run = [this, draw, channels](std::uint64_t number, std::span<Complex> sums) {
      std::vector<double> intensity(channels);
      draw(number, std::span(drawn_.field).subspan(number * channels, channels), intensity);
      std::copy(intensity.begin(), intensity.end(), sums.begin());
    };
    return job;
  }

  const Scene& scene_;
  const DrawingSettings& settings_;
  Plan plan_;
  DrawnFields drawn_;
};

}  // namespace

DrawnFields draw_fields(const Scene& scene, const FieldDemand& demand,
                        const DrawingSettings& settings,
                        const std::function<void(const DrawingPlan&)>& planned) {
  return FieldDrawing(scene, settings).draw(demand, planned);
}

const DatasetTable field_table{
    .name = "field",
    .rows = {{"realization", Data::numbers, "", "1", "index of the field"},
             {"tilt", Data::real, "light_angle", "rad", "rotation of the light"},
             {"tilt_q", Data::real, "light_angle", "1/length", "transverse wavenumber of the tilt"},
             {"delay", Data::scale, "", "DELAY", "time of the field"},
             {"frequency_shift", Data::scale, "", "1",
              "change of the frequency of the field, relative to it"},
             {"image_x", Data::scale, "", "length", "x of a column of pixels of an image"},
             {"image_y", Data::scale, "", "length", "y of a row of pixels of an image"},
             {"field", Data::complex, "realization MEMBER VIEW", "FIELD",
              "speckle field without its mean"},
             {"intensity", Data::estimate, "MEMBER VIEW", "COVARIANCE",
              "variance of the drawn fields"},
             {"contrast", Data::estimate, "MEMBER VIEW", "1",
              "standard deviation over mean of the intensity"},
             {"mean_contrast", Data::estimate, "", "1", "contrast of I / <I> over all channels"},
             {"circularity", Data::complex_estimate, "", "1", "<u u> / <I> over all channels"},
             {"intensity_bin", Data::scale, "", "1",
              "lower edge of a bin of intensity over its mean; the last bin is open"},
             {"histogram", Data::estimate, "intensity_bin", "1", "number of values in the bin"},
             {"histogram_expected", Data::real, "intensity_bin", "1",
              "number of values in the bin expected by the exponential law"},
             {"view_lag", Data::scale, "", "LAG",
              "difference of the sines of two views, or distance of two sensors"},
             {"intensity_autocorrelation", Data::estimate, "view_lag", "1",
              "<I I'> / (<I> <I'>) - 1 over the first light's views"},
             {"grain_width", Data::estimate, "", "LAG",
              "full width of intensity_autocorrelation at half its maximum: the size of a speckle; "
              "on a "
              "camera the mean over rows and columns"},
             {"siegert", Data::estimate, "view_lag", "1",
              "|<u u'*>|^2 / (<I> <I'>) over the same views, from light paths"}},
    .attributes =
        {{"field", "method", "text", "paths or covariance: what the fields were drawn from"},
         {"field", "paths_per_field", "uint64", "light paths of each field, if drawn from paths"},
         {"field", "excess_kurtosis", "float64",
          "expected E|u|^4/(E|u|^2)^2 - 2, if drawn from paths"},
         {"field", "camera_error", "float64",
          "relative rms error of the sums over pixels, if paths are summed on a camera"},
         {"field", "camera_nodes", "uint64",
          "interpolation nodes along each side of the camera, if paths are summed on one"},
         {"tilt_q", "azimuth", "float64",
          "azimuth of the tilts, from x towards y, if they are not in the plane y = 0"},
         {"image_x", "focus", "float64", "depth of the plane that is in focus"},
         {"field", "covariance_paths", "uint64", "light paths of the covariance, if drawn from it"},
         {"field", "paths_cost", "float64",
          "cost of drawing all fields from paths, in complex multiply-adds"},
         {"field", "covariance_cost", "float64",
          "cost of drawing all fields from the covariance, in complex multiply-adds, if it fits "
          "into memory"}},
    .roles = {{"LAG", {"1", "length"}},
              {"MEMBER", {"light_angle", "light", "delay", "frequency_shift"}},
              {"DELAY", {"1", "s"}}}};

namespace {

std::vector<double> steps(std::size_t count, double step) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(step * static_cast<double>(i));
  return values;
}

/// Writes the axis of the fields of a realization.
void write_members(ResultFile& file, const Scene& scene, const FieldChanges& changes) {
  const ResultGroup root(file, field_table);
  file.bind("MEMBER", file.bound("LIGHT"));
  if (!changes.delays.empty()) {
    file.bind("MEMBER", {"delay"});
    file.bind("DELAY", {changes.in_seconds ? "s" : "1"});
    return root.put("delay", changes.delays);
  }
  if (!changes.shifts.empty()) {
    file.bind("MEMBER", {"frequency_shift"});
    root.put("frequency_shift", changes.shifts);
  }
  if (scene.request.tilts.empty()) return;
  root.put("tilt", scene.request.tilts);
  root.put("tilt_q", scene.request.tilt_q);
  if (const double azimuth = scene.request.tilt_azimuth; azimuth != 0)
    root.attribute("tilt_q", "azimuth", azimuth);
}

void write_image_axes(ResultFile& file, const LensPlane& image) {
  const ResultGroup root(file, field_table);
  file.bind("VIEW", {"image_y", "image_x"});
  file.bind("FIELD", {"1"});
  file.bind("COVARIANCE", {"1"});
  std::vector<double> at;
  for (std::size_t i = 0; i < image.pixels; ++i) at.push_back(image.coordinate(i));
  root.put("image_x", at);
  root.put("image_y", at);
  root.attribute("image_x", "focus", image.focus);
}

void write_field_axes(ResultFile& file, const Scene& scene, const DrawnFields& drawn) {
  write_light_axis(file, scene.request.lights);
  bind_units(file, scene);
  if (drawn.image)
    write_image_axes(file, *drawn.image);
  else
    write_view_axis(file, scene.request.views, scene.request.camera);
  write_members(file, scene, drawn.changes);
}

/// Writes the fields in chunks of about a mebibyte.
void write_field(ResultFile& file, const Scene& scene, const DrawnFields& drawn) {
  const std::size_t lights = fields_of(scene, drawn), views = pixels_of(scene, drawn),
                    channels = lights * views, realizations = drawn.field.size() / channels;
  constexpr std::size_t chunk_values = std::size_t{1} << 16;
  const std::size_t at_once = std::clamp<std::size_t>(chunk_values / channels, 1, realizations),
                    chunk_lights = std::clamp<std::size_t>(chunk_values / views, 1, lights);
  const ResultGroup root(file, field_table);
  root.number("realization", realizations);
  const bool camera = scene.request.camera.has_value();
  const auto with_views = [&](std::vector<std::size_t> extents, std::size_t rows, std::size_t all) {
    if (camera) extents.push_back(rows);
    extents.push_back(all);
    return extents;
  };
  const std::size_t columns = drawn.image ? drawn.image->pixels
                              : camera    ? scene.request.camera->pixels
                                          : views;
  root.begin("field", with_views({at_once, chunk_lights},
                                 std::clamp<std::size_t>(chunk_values / columns, 1, columns),
                                 std::min(columns, chunk_values)));
  for (std::size_t first = 0; first < realizations; first += at_once) {
    const std::size_t count = std::min(at_once, realizations - first);
    file.write_block("field", std::span(drawn.field).subspan(first * channels, count * channels),
                     with_views({first, 0}, 0, 0), with_views({count, lights}, columns, columns));
  }
}

void write_plan(const ResultGroup& root, const DrawingPlan& plan) {
  const bool by_paths = plan.method == FieldMethod::paths;
  root.attribute("field", "method", std::string(by_paths ? "paths" : "covariance"));
  if (by_paths) {
    root.attribute("field", "paths_per_field", plan.paths_per_field);
    root.attribute("field", "excess_kurtosis", plan.excess);
    if (plan.camera) {
      root.attribute("field", "camera_error", plan.camera->error);
      root.attribute("field", "camera_nodes", static_cast<std::uint64_t>(plan.camera->nodes));
    }
  } else {
    root.attribute("field", "covariance_paths", plan.covariance_paths);
  }
  root.attribute("field", "paths_cost", plan.paths_cost);
  if (std::isfinite(plan.covariance_cost))
    root.attribute("field", "covariance_cost", plan.covariance_cost);
}

/// Writes the counts of |u|^2 / <|u|^2> in the bins [intensity_bin, intensity_bin + 1/4); the last
/// bin has no upper edge. The errors are at least one count.
void write_histogram(const ResultGroup& root, const FieldStatistics& statistics) {
  const double values = statistics.values();
  Estimate counts = statistics.histogram();
  for (Complex& count : counts.value) count *= values;
  for (double& error : counts.error) error = std::max(1.0, error * values);
  root.put("intensity_bin", steps(FieldStatistics::bins, FieldStatistics::bin_width));
  root.put("histogram", counts);
  root.put("histogram_expected", column(FieldStatistics::exponential_law(),
                                        [&](double share) { return share * values; }));
}

/// Returns the step between pixels, as a difference of direction cosines or, in an image, as a
/// length. Returns nullopt if a line of pixels is too short for an autocorrelation.
std::optional<double> pixel_step(const Scene& scene, const DrawnFields& drawn) {
  constexpr std::size_t fewest = 8;
  if (drawn.image) {
    if (drawn.image->pixels < fewest) return std::nullopt;
    return drawn.image->coordinate(1) - drawn.image->coordinate(0);
  }
  const FarCamera& camera = *scene.request.camera;
  if (camera.pixels < fewest) return std::nullopt;
  return 2 * camera.aperture / static_cast<double>(camera.pixels);
}

}  // namespace

FieldSummary write_fields(ResultFile& file, const Scene& scene, const DrawnFields& drawn) {
  const auto& views = scene.request.views;
  const std::size_t pixels = pixels_of(scene, drawn), channels = fields_of(scene, drawn) * pixels;
  const bool camera = scene.request.camera.has_value();
  const auto step = camera ? std::nullopt : equal_step(views);
  const auto spacing = camera ? pixel_step(scene, drawn) : step;
  const auto realizations = static_cast<double>(drawn.field.size() / channels);
  const bool own_mean = drawn.image || drawn.plan.has_own_mean;
  FieldStatistics statistics(real_parts(drawn.intensity.value), pixels, spacing.has_value(),
                             own_mean ? 1 + 1 / realizations : 1, camera);
  for (std::size_t first = 0; first < drawn.field.size(); first += channels)
    statistics.add(std::span(drawn.field).subspan(first, channels));

  write_field_axes(file, scene, drawn);
  write_field(file, scene, drawn);
  const ResultGroup root(file, field_table);
  write_plan(root, drawn.plan);
  FieldSummary summary{statistics.mean_contrast(), statistics.circularity(),
                       step ? statistics.autocorrelation() : Estimate{},
                       spacing ? statistics.grain_width() : std::nullopt};
  file.bind("LAG", {drawn.image || views.front().near ? "length" : "1"});
  if (summary.grain_width) {
    summary.grain_width->value.front() *= *spacing;
    summary.grain_width->error.front() *= *spacing;
    root.put("grain_width", *summary.grain_width);
  }
  root.put("intensity", drawn.intensity);
  root.put("contrast", statistics.contrast());
  root.put("mean_contrast", summary.mean_contrast);
  root.put("circularity", summary.circularity);
  write_histogram(root, statistics);
  if (!step) return summary;
  root.put("view_lag", steps(views.size(), *step));
  root.put("intensity_autocorrelation", summary.autocorrelation);
  if (!drawn.siegert.value.empty()) root.put("siegert", drawn.siegert);
  return summary;
}

}  // namespace flatspeckle::mc
