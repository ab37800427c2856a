#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "apps/command/experiment.h"
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

/// Values of the keys of the subcommand `image`.
struct ImageKeys {
  SceneSpec spec;
  std::vector<double> object_x, object_brightness;
  std::optional<double> object_depth, object_extent, camera_depth, reference_x, memory_range;
  double object_scale = 1;
  std::optional<std::int64_t> object_count;
  std::vector<double> camera;
  std::int64_t pixels = 4096, repeats = 16, average = 1;
  std::optional<std::int64_t> points, paths_per_field;
  double resolution = 1;
  mc::CameraNoise noise;
  mc::DeconvolutionKeys deconvolution;
  std::string method = "paths";
  std::int64_t prediction_paths = 20000;
  std::string blinking = "none";
  std::int64_t blinking_frames = 50, excitation_paths = 20000;
  double lit = 0.5;
  std::optional<double> excitation_wavelength, excitation_optical_depth;
  std::optional<std::int64_t> sources;
  MethodSettings estimation;
};

void add_object_keys(Keys& keys, ImageKeys& values) {
  keys.group("Object and camera");
  keys.add("object_x", values.object_x, "x of the object's points, which are mutually incoherent")
      .unit("length");
  keys.add("object_brightness", values.object_brightness, "Brightness of each point (default: 1)")
      .positive();
  keys.add("object_count", values.object_count,
           "Number of object points used, in the order given (default: all)")
      .positive();
  keys.add("object_scale", values.object_scale, "Factor by which object_x is multiplied")
      .positive();
  keys.add("object_depth", values.object_depth,
           "z of the line on which the object's points lie, outside the box")
      .unit("length");
  keys.add("camera_depth", values.camera_depth,
           "z of the line on which the camera's pixels lie, outside the box (default: at infinity, "
           "behind the box)")
      .unit("length");
  keys.add("camera", values.camera,
           "First and last pixel: x if camera_depth is given, otherwise the sine of the direction")
      .exactly(2, "first last");
  keys.add("pixels", values.pixels, "Number of pixels of the camera").from(64, 1 << 20);
  add_camera_keys(keys, values.noise);
  keys.add("background", values.noise.background,
           "Uniform background light, relative to the mean light over the pixels")
      .not_negative();
}

void add_reference_keys(Keys& keys, ImageKeys& values) {
  keys.group("Reference");
  keys.add("reference_x", values.reference_x,
           "x of a reference point on the object's line; frames are divided (deconvolved) by its "
           "frame")
      .unit("length");
  add_keys(keys, values.deconvolution);
}

void add_blinking_keys(Keys& keys, ImageKeys& values) {
  keys.group("Blinking");
  keys.add("blinking", values.blinking,
           "How the brightness of points varies between the frames of a medium: not at all (none), "
           "by random subsets, or by excitation with a different speckle pattern in each frame "
           "(speckle)")
      .one_of({"none", "subsets", "speckle"});
  keys.add("blinking_frames", values.blinking_frames, "Number of frames of each medium")
      .from(2, 100000);
  keys.add("lit", values.lit, "blinking = subsets: fraction of the frames in which a point shines")
      .between(0, 1);
  keys.add("excitation_wavelength", values.excitation_wavelength,
           "blinking = speckle: wavelength of the exciting light (default: wavelength)")
      .positive()
      .unit("length");
  keys.add("excitation_optical_depth", values.excitation_optical_depth,
           "blinking = speckle: optical depth of the medium at excitation_wavelength (default: "
           "optical_depth)")
      .positive();
  keys.add("excitation_paths", values.excitation_paths,
           "blinking = speckle: number of light paths for the covariance of the exciting field "
           "between the points")
      .positive();
  keys.add("sources", values.sources,
           "Number of sources into which frames are separated (default: determined from the "
           "singular values of the frames)")
      .from(1, 64);
}

void add_image_keys(Keys& keys, ImageKeys& values) {
  add_scatterer_keys(keys, values.spec);
  add_bulk_keys(keys, values.spec);
  add_medium_keys(keys, values.spec);
  add_profile_keys(keys, values.spec);
  add_structure_key(keys, values.spec);
  add_object_keys(keys, values);
  add_reference_keys(keys, values);
  add_blinking_keys(keys, values);
  keys.group("Pictures");
  keys.add("repeats", values.repeats,
           "Number of random media, with one frame each; points are searched in each frame (0: "
           "compute only the prediction)")
      .from(0, std::numeric_limits<double>::infinity());
  mc::add_average_key(keys, values.average);
  keys.add("method", values.method,
           "paths: fields by light paths; wave: fields of placements by the exact solver")
      .one_of({"paths", "wave"});
  keys.add("paths_per_field", values.paths_per_field,
           "Number of light paths of each medium (default: enough for an excess kurtosis of 0.01, "
           "and at least four per visible grain)")
      .positive();
  add_wave_keys(keys, values.estimation);
  keys.remove("wave_samples");
  keys.add("points", values.points,
           "Number of points to recover (default: number of object points; 0: no search)")
      .from(0, 64);
  keys.add("object_extent", values.object_extent,
           "Longest distance between points in the search (default: 1.25 times the extent of the "
           "object)")
      .positive()
      .unit("length");
  keys.add("resolution", values.resolution,
           "Smallest distance between points, and tolerance within which a point counts as "
           "recovered, in speckle grains")
      .positive();
  keys.add("memory_range", values.memory_range,
           "Distance between two points at which the intensity correlation C_I of their speckles "
           "is 1/2; determines the weights of pairs in the search (default: equal weights)")
      .positive()
      .unit("length");
  keys.add("prediction_paths", values.prediction_paths,
           "Number of light paths for the prediction of the correlation peaks of pairs of points")
      .positive();
}

mc::LineObject object_of(const Keys& keys, const ImageKeys& values) {
  mc::LineObject object{keys.required(values.object_x), keys.read(values.object_brightness)};
  if (object.brightness.empty()) object.brightness.assign(object.x.size(), 1);
  if (object.brightness.size() != object.x.size())
    throw InputError("object_brightness: has " + std::to_string(object.brightness.size()) +
                     " values, must have one for each of the " + std::to_string(object.x.size()) +
                     " points");
  for (double& x : object.x) x *= keys.read(values.object_scale);
  if (const auto& count = keys.read(values.object_count)) {
    if (static_cast<std::size_t>(*count) > object.x.size())
      throw InputError("object_count", *count,
                       "must be at most " + std::to_string(object.x.size()) +
                           ", the number of points in object_x");
    object.x.resize(static_cast<std::size_t>(*count));
    object.brightness.resize(object.x.size());
  }
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

/// Subtracts the mean over all n realizations from each field. The differences are multiplied by
/// sqrt(n / (n - 1)), so that their variance is unbiased.
void remove_mean(std::vector<Complex>& fields, std::size_t channels) {
  const std::size_t count = fields.size() / channels;
  const auto n = static_cast<double>(count);
  for (std::size_t c = 0; c < channels; ++c) {
    Complex mean = 0;
    for (std::size_t r = 0; r < count; ++r) mean += fields[r * channels + c] / n;
    for (std::size_t r = 0; r < count; ++r) {
      Complex& field = fields[r * channels + c];
      field = (field - mean) * std::sqrt(n / (n - 1));
    }
  }
}

/// Returns the exact fields of all placements minus their mean (the coherent field), so that only
/// the speckle is left, as in fields computed by light paths.
mc::FieldDraw exact_fields(const mc::LineScene& line, const mc::ImagingTask& task,
                           double tolerance) {
  const BatchJob exact = wave_estimation(line.scene, tolerance, task.seed).job.batches;
  const std::size_t channels = line.scene.request.channels.size();
  const std::uint64_t media = task.repeats * task.average;
  const auto fields = std::make_shared<std::vector<Complex>>(media * channels);
  BatchJob job;
  job.size = 1;
  job.run = [&](std::uint64_t number, std::span<Complex>) {
    std::vector<Complex> sums(exact.size);
    exact.run(number, sums);
    std::copy_n(sums.begin(), channels, fields->begin() + static_cast<long>(number * channels));
  };
  RunState state;
  run_to_end(job, {{media, std::nullopt, std::nullopt}, task.threads, "wave", {}}, state);
  remove_mean(*fields, channels);
  return [fields, channels](std::uint64_t number, std::span<Complex> field, std::span<double>) {
    std::copy_n(fields->begin() + static_cast<long>(number * channels), channels, field.begin());
  };
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
    return {exact_fields(line, task, wave_tolerance),
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
    if (keys.read(values_.method) == "wave")
      keys.read(values_.estimation.wave_tolerance);
    else
      keys.read(values_.paths_per_field);
    mc::LineObject object = object_of(keys, values_);
    const double object_depth = keys.required(values_.object_depth);
    const mc::LineCamera camera = camera_of(keys, values_);
    const std::optional<double> reference = keys.read(values_.reference_x);
    keys.read(values_.prediction_paths);
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

 private:
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
    mc::ImagingTask task = task_;
    if (task.repeats > 0) set_brightness(task);
    const auto fields = fields_of(*line_, task_, values_.method, values_.estimation.wave_tolerance,
                                  values_.paths_per_field);
    const auto prediction = mc::predicted(
        *line_, static_cast<std::uint64_t>(values_.prediction_paths), task_.seed, task_.threads);
    const auto media = mc::imaged(*line_, task, fields.draw);
    write_medium(file, line_->scene);
    mc::write_imaging(file, *line_, task, media, prediction);
    check_power(file, "", line_->scene,
                {"mc", static_cast<double>(values_.prediction_paths), 0, task_.seed});
    if (prints) print_summary(*line_, task, media, prediction);
    return Made{fields.how, static_cast<double>(task_.repeats * task_.average)};
  }

  ImageKeys values_;
  mc::ImagingTask task_;
  std::optional<SceneSpec> excitation_;
  std::optional<Scene> excited_;
  std::optional<mc::LineScene> line_;
};

}  // namespace

std::unique_ptr<Experiment> image_experiment() {
  return std::make_unique<ImageExperiment>();
}

}  // namespace flatspeckle::apps
