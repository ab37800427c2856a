#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "apps/command/experiment.h"
#include "apps/flatland/image_keys.h"
#include "apps/flatland/picture_image.h"
#include "apps/results/estimation.h"
#include "apps/results/view_power.h"
#include "core/error.h"
#include "core/numbers/address_space.h"
#include "core/run/runner.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/imaging/imaging_datasets.h"
#include "mc/imaging/media_statistics.h"
#include "mc/imaging/recovery/recovery.h"

namespace flatspeckle::apps {

namespace {

mc::LineObject object_of(const Keys& keys, const ImageKeys& values) {
  mc::LineObject object{keys.required(values.object_x), {}};
  object.brightness = brightness_of(keys, values, object.x.size());
  for (double& x : object.x) x *= keys.read(values.object_scale);
  const std::size_t count = count_of(keys, values, object.x.size());
  object.x.resize(count);
  object.brightness.resize(count);
  return object;
}

mc::LineCamera camera_of(const Keys& keys, const ImageKeys& values) {
  const auto& ends = keys.required(values.camera);
  if (!(ends[0] < ends[1]))
    throw InputError("camera", ends[1], "must be larger than the first value");
  const auto& depth = keys.read(values.camera_depth);
  if (!depth && !(ends[0] > -1 && ends[1] < 1))
    throw InputError("camera: must be sines of directions between -1 and 1");
  return {depth, ends[0], ends[1], static_cast<std::size_t>(keys.read(values.pixels))};
}

/// Returns the number of lags of the autocorrelation, in pixels, that is needed for the longest
/// distance between points. Throws InputError if it is too large for the camera.
std::size_t lags_of(const mc::LineScene& line, const std::optional<double>& object_extent) {
  std::vector<double> x = line.object.x;
  if (line.reference) x.push_back(*line.reference);
  const auto [first, last] = std::minmax_element(x.begin(), x.end());
  const double extent = object_extent.value_or(1.25 * (*last - *first)),
               lags = std::ceil(extent * std::abs(magnification(line))) + 16,
               most = static_cast<double>(line.camera.pixels) / 4;
  if (!(lags <= most))
    throw InputError("object_extent", extent,
                     "corresponds to " + std::to_string(static_cast<long>(lags)) +
                         " pixels, more than a quarter of the camera's pixels; reduce it");
  return static_cast<std::size_t>(lags);
}

/// Throws InputError if no point of the object lies in the deconvolved picture, which extends
/// `lags` pixels to either side of the reference point.
void require_picture(const mc::LineScene& line, std::size_t lags) {
  if (!line.reference) return;
  const auto away = shifts(line).x;
  const auto in_picture = [&](double x) { return std::abs(x) < static_cast<double>(lags); };
  if (std::ranges::none_of(away, in_picture))
    throw InputError("reference_x", *line.reference,
                     "must be within object_extent of a point of the object");
}

/// Makes the imaging task from the keys. The number of lags is set later.
mc::ImagingTask task_of(const Keys& keys, const ImageKeys& values, std::size_t points) {
  mc::ImagingTask task;
  task.repeats = static_cast<std::uint64_t>(keys.read(values.repeats));
  task.average = static_cast<std::uint64_t>(keys.read(values.average));
  read_camera_keys(keys, values.noise, task.recovery.noise);
  task.recovery.noise.background = keys.read(values.noise.background);
  if (keys.read(values.reference_x) && task.average > 1)
    throw InputError("average", task.average,
                     "must be 1 with reference_x: frames with a reference are not averaged");
  if (keys.read(values.reference_x))
    task.deconvolution = deconvolution_task(keys, values.deconvolution);
  if (const auto& sought = keys.read(values.points)) points = static_cast<std::size_t>(*sought);
  // not for a single point, which has no distances to recover
  if (points > 1) task.recovery.points = points;
  if (task.recovery.points == 0) return task;
  task.recovery.resolution_grains = keys.read(values.resolution);
  task.recovery.memory_range = keys.read(values.memory_range).value_or(0);
  return task;
}

/// Makes the task for frames with blinking points. The brightness of the points is set later by
/// set_brightness().
mc::BlinkingTask blinking_of(const Keys& keys, const ImageKeys& values,
                             const mc::ImagingTask& task) {
  mc::BlinkingTask blinking;
  blinking.frames = static_cast<std::size_t>(keys.read(values.blinking_frames));
  if (task.average > 1)
    throw InputError("average", task.average,
                     "must be 1 with blinking: its frames show one medium and are not averaged");
  if (keys.read(values.reference_x))
    throw InputError("reference_x", *values.reference_x, "must not be given with blinking");
  blinking.separates = task.recovery.points > 0;
  blinking.separation.noise = task.recovery.noise;
  if (!blinking.separates) return blinking;
  blinking.separation.sources = static_cast<std::size_t>(keys.read(values.sources).value_or(0));
  blinking.separation.resolution_grains = task.recovery.resolution_grains;
  if (blinking.separation.sources > blinking.frames)
    throw InputError("sources", blinking.separation.sources, "must be at most blinking_frames");
  return blinking;
}

/// Returns the keys of the scene with the wavelength and the optical depth of the excitation light
/// of the fluorescent points.
SceneSpec excitation_spec(const Keys& keys, const ImageKeys& values) {
  SceneSpec spec = values.spec;
  spec.wavelength = keys.read(values.excitation_wavelength).value_or(spec.wavelength);
  if (const auto& depth = keys.read(values.excitation_optical_depth)) {
    if (!spec.optical_depth)
      throw InputError("excitation_optical_depth", *depth, "requires a medium with optical_depth");
    spec.optical_depth = depth;
  }
  return spec;
}

/// Throws InputError if frames and fields do not fit into memory. lights: number of object points
/// and reference points. keeps_fields: whether the fields of all realizations of the medium are in
/// memory at once, as with exact solutions.
void check_memory(std::size_t lights, const mc::LineCamera& camera, const mc::ImagingTask& task,
                  bool keeps_fields) {
  const auto pixels = static_cast<double>(camera.pixels),
             channels = pixels * static_cast<double>(lights);
  const auto frames = static_cast<double>(task.average * task.blinking.frames);
  const double of_a_repeat =
                   sizeof(double) * 2 * pixels +
                   (keeps_fields ? sizeof(Complex) * channels * static_cast<double>(task.average)
                                 : 0),
               at_once = (32 * channels + sizeof(double) * pixels * frames) * task.threads;
  const double bytes = at_once + static_cast<double>(task.repeats) * of_a_repeat;
  if (bytes > 0.8 * usable_memory())
    throw InputError("repeats", task.repeats,
                     "frames and fields need " + std::to_string(bytes / 1e9) +
                         " GB of memory; reduce repeats or pixels");
}

struct ImagedFields {
  mc::FieldDraw draw;
  std::string how;
};

ImagedFields fields_of(const mc::LineScene& line, const mc::ImagingTask& task,
                       const std::string& method, double wave_tolerance,
                       const std::optional<std::int64_t>& paths_per_field) {
  if (task.repeats == 0) return {{}, "prediction only, without frames"};
  if (method == "wave")
    return {exact_fields(line.scene, task.repeats * task.average, task.seed, task.threads,
                         wave_tolerance),
            "wave: placements by the exact solver, minus their mean field"};
  const auto paths = paths_per_field ? static_cast<std::uint64_t>(*paths_per_field)
                                     : mc::paths_for_fields(line, task.seed, task.threads);
  const mc::Plan plan = mc::make_plan(line.scene, mc::ReversedPaths::automatic);
  return {mc::fields_by_paths(line.scene, plan, task.seed, paths),
          "mc: fields of " + std::to_string(paths) + " light paths; " + plan.describe()};
}

void print_pictures(const mc::LineScene& line, const mc::ImagingTask& task,
                    const std::vector<mc::ImagedMedium>& media,
                    const mc::ImagingPrediction& prediction) {
  std::printf("frames divided by the reference: ");
  if (!media.empty()) {
    const mc::MeanOverMedia mean = mc::mean_psnr(media);
    std::printf("PSNR %.1f", mean.value);
    if (media.size() > 1) std::printf(" +- %.2g", mean.error);
    std::printf(" dB");
  }
  if (task.deconvolution.method == mc::DeconvolutionTask::Method::wiener)
    std::printf("%sexpected %.1f dB", media.empty() ? "" : ", ",
                mc::expected_psnr(line, task, prediction));
  std::puts("");
}

void print_moments(const mc::LineScene& line, const mc::ImagingTask& task,
                   const std::vector<mc::ImagedMedium>& media) {
  const mc::MeanOverMedia contrast = mc::mean_contrast(line.object, media),
                          fourth = mc::mean_fourth_moment(media);
  std::printf(
      "contrast %.4f +- %.2g (Gaussian: %.4f), E|u|^4/(E|u|^2)^2 %.3f +- %.2g, %.0f grains\n",
      contrast.value, contrast.error,
      mc::gaussian_contrast(line.object, task.recovery.noise.background), fourth.value,
      fourth.error, mc::mean_grains(media));
}

void print_sources(const mc::ImagingTask& task, const std::vector<mc::ImagedMedium>& media) {
  const mc::FrameContrast contrast = mc::frame_contrast(media);
  std::printf("single frames: contrast %.4f +- %.2g (Gaussian: %.4f)\n", contrast.found.value,
              contrast.found.error, contrast.expected);
  if (!task.blinking.separates) return;
  const mc::MeanOverMedia rate = mc::sources_success(media),
                          count = mc::mean_over(media, 0, [](const auto&m) {
                            return static_cast<double>(m.blinked.found.count.sources);
                          });
  std::printf(
      "%.3g sources by singular values; all points recovered as sources in %.3g +- %.2g of the "
      "media\n",
      count.value, rate.value, rate.error);
}

void print_summary(const mc::LineScene& line, const mc::ImagingTask& task,
                   const std::vector<mc::ImagedMedium>& media,
                   const mc::ImagingPrediction& prediction) {
  if (!media.empty()) print_moments(line, task, media);
  const auto expected = mc::expected_peaks(line, task, prediction);
  if (const auto correlation = real_parts(prediction.correlation.value); !correlation.empty())
    std::printf("pairs of points: smallest C_I %.3f, smallest peak %.1f times the noise\n",
                *std::min_element(correlation.begin(), correlation.end()),
                *std::min_element(expected.signals.begin(), expected.signals.end()));
  if (line.reference) print_pictures(line, task, media, prediction);
  if (task.blinking.draw && !media.empty()) print_sources(task, media);
  if (task.recovery.points > 0 && !media.empty()) {
    const auto [rate, error] = mc::success_rate(media);
    std::printf("all %zu points recovered in %.3g +- %.2g of the media\n", line.object.x.size(),
                rate, error);
  }
  if (expected.success) std::printf("expected success rate %.3g\n", *expected.success);
  const std::size_t alike = mc::alike_pairs(line, task.recovery.resolution_grains);
  if (expected.success && alike > 0)
    std::printf(
        "%zu pairs of points have distances equal within a grain: the search requires distinct "
        "distances and may miss them\n",
        alike);
}

class ImageExperiment : public OneShot {
 public:
  void add_keys(Keys& keys) override {
    add_image_keys(keys, values_);
    add_seed_key(keys, run_, "Random seed; medium n of a seed is always the same");
    add_thread_key(keys, run_);
    add_output_key(keys, run_);
  }

  void read(const Keys& keys) override {
    keys.read(values_.space.length_unit);
    if (keys.read(values_.spec.dimension) == 3)
      pictures_ = picture_run(keys, values_, seed(), threads());
    else
      read_line(keys);
  }

 private:
  /// Reads the keys of `image` in the plane.
  void read_line(const Keys& keys) {
    if (keys.read(values_.method) == "wave")
      keys.read(values_.estimation.wave_tolerance);
    else
      keys.read(values_.paths_per_field);
    mc::LineObject object = object_of(keys, values_);
    const auto& depths = keys.required(values_.object_depth);
    if (depths.size() != 1)
      throw InputError("object_depth", depths.size(), "values: must be one in the plane");
    const double object_depth = depths.front();
    const mc::LineCamera camera = camera_of(keys, values_);
    const std::optional<double> reference = keys.read(values_.reference_x);
    prediction_paths_ = prediction_paths(keys, values_);
    task_ = task_of(keys, values_, object.x.size());
    if (by_waves() && task_.repeats * task_.average < 2)
      throw InputError("repeats", task_.repeats,
                       "repeats times average must be at least 2 with method = wave, which "
                       "subtracts the mean field of all media");
    task_.seed = seed();
    task_.threads = threads();
    const auto& object_extent = keys.read(values_.object_extent);
    const bool blinks = keys.read(values_.blinking) != "none";
    if (blinks && task_.repeats == 0)
      throw InputError("blinking", values_.blinking, "requires frames: repeats must be at least 1");
    if (blinks) task_.blinking = blinking_of(keys, values_, task_);
    if (values_.blinking == "subsets") keys.read(values_.lit);
    if (by_speckle()) {
      keys.read(values_.excitation_paths);
      excitation_ = excitation_spec(keys, values_);
    }
    Scene medium = make_scene(keys, values_.spec);
    if (medium.domain.kind == Domain::Kind::slab) throw InputError("domain", "slab", "must be box");
    check_memory(object.x.size() + (reference ? 1 : 0), camera, task_, by_waves());
    line_ = mc::line_scene(std::move(medium), std::move(object), object_depth, camera, reference);
    task_.recovery.lags = task_.blinking.separation.lags = lags_of(*line_, object_extent);
    require_picture(*line_, task_.recovery.lags);
    if (blinks)
      task_.recovery.noise = mc::noise_of_mean(task_.recovery.noise, task_.blinking.frames);
    if (excitation_) excited_ = make_scene(*excitation_);
    task_.recovery.memory_range *= std::abs(magnification(*line_));
  }

  bool by_waves() const { return values_.method == "wave"; }
  bool by_speckle() const { return values_.blinking == "speckle"; }
  ResultFile::Storage storage() const override { return ResultFile::Storage::disk; }

  /// Sets how the brightness of blinking points is drawn for each frame.
  void set_brightness(mc::ImagingTask& task) const {
    if (values_.blinking == "subsets")
      task.blinking.draw =
          mc::random_subsets(task.blinking.frames, line_->object.x.size(), values_.lit, task.seed);
    if (!excited_) return;
    auto excitation = mc::speckle_excitation(
        *excited_, *line_,
        {task.blinking.frames, static_cast<std::uint64_t>(values_.excitation_paths), task.seed,
         task.threads});
    task.blinking.draw = std::move(excitation.draw);
    task.blinking.correlation = std::move(excitation.correlation);
  }

  Made make(ResultFile& file, bool prints) const override {
    if (pictures_) return make_pictures(file, *pictures_, prints);
    mc::ImagingTask task = task_;
    if (task.repeats > 0) set_brightness(task);
    const auto fields = fields_of(*line_, task_, values_.method, values_.estimation.wave_tolerance,
                                  values_.paths_per_field);
    const auto prediction = mc::predicted(*line_, prediction_paths_, task_.seed, task_.threads);
    const auto media = mc::imaged(*line_, task, fields.draw);
    write_medium(file, line_->scene);
    mc::write_imaging(file, *line_, task, media, prediction);
    check_power(file, "", line_->scene,
                {"mc", static_cast<double>(prediction_paths_), 0, task_.seed});
    if (prints) print_summary(*line_, task, media, prediction);
    return Made{fields.how, static_cast<double>(task_.repeats * task_.average)};
  }

  ImageKeys values_;
  mc::ImagingTask task_;
  std::uint64_t prediction_paths_ = 0;
  std::optional<SceneSpec> excitation_;
  std::optional<Scene> excited_;
  std::optional<mc::LineScene> line_;
  std::optional<PictureRun> pictures_;  ///< in space
};

}  // namespace

std::unique_ptr<Experiment> image_experiment() {
  return std::make_unique<ImageExperiment>();
}

}  // namespace flatspeckle::apps
