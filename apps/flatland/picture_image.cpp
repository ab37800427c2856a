#include "apps/flatland/picture_image.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "apps/results/estimation.h"
#include "apps/results/extras.h"
#include "apps/results/view_power.h"
#include "core/error.h"
#include "core/frames/frames.h"
#include "core/keys/number_text.h"
#include "core/numbers/address_space.h"
#include "core/run/runner.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/imaging/simulated/picture_frame_datasets.h"
#include "mc/imaging/simulated/picture_prediction.h"
#include "mc/jobs/delay_results.h"

namespace flatspeckle::apps {

namespace {

constexpr std::size_t most_points = 4096;

/// Returns the depths of the points, or none for an object at infinity.
std::vector<double> depths_of(const Keys& keys, const ImageKeys& values, std::size_t points) {
  const auto& depths = keys.read(values.object_depth);
  if (depths.size() > 1 && depths.size() != points)
    throw InputError("object_depth: has " + std::to_string(depths.size()) +
                     " values, must have one for all or one for each of the " +
                     std::to_string(points) + " points");
  return depths.size() == 1 ? std::vector<double>(points, depths.front()) : depths;
}

/// Returns the points of the keys object_x and object_y.
mc::PictureObject points_of(const Keys& keys, const ImageKeys& values) {
  const auto& x = keys.read(values.object_x);
  const auto& y = keys.read(values.space.object_y);
  if (!y.empty() && y.size() != x.size())
    throw InputError("object_y: has " + std::to_string(y.size()) +
                     " values, must have one for each of the " + std::to_string(x.size()) +
                     " points of object_x");
  mc::PictureObject object;
  object.brightness = brightness_of(keys, values, x.size());
  const auto depths = depths_of(keys, values, x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    object.place.push_back({x[i], depths.empty() ? 0 : depths[i], y.empty() ? 0 : y[i]});
  const std::size_t count = count_of(keys, values, x.size());
  object.place.resize(count);
  object.brightness.resize(count);
  return object;
}

/// Returns the depth of an object that lies in a plane; 0 for an object at infinity.
double depth_of_plane(const Keys& keys, const ImageKeys& values) {
  const auto& depths = keys.read(values.object_depth);
  if (depths.size() > 1)
    throw InputError("object_depth: has " + std::to_string(depths.size()) +
                     " values, must have one for a picture or a disc");
  return depths.empty() ? 0 : depths.front();
}

/// Returns the pixels of a picture that are not dark.
mc::PictureObject picture_points(const Keys& keys, const ImageKeys& values) {
  const std::string& path = keys.read(values.space.object_picture);
  const double width = keys.required(values.space.object_width),
               depth = depth_of_plane(keys, values);
  const Frames read = read_frames("object_picture", path, {"", "picture", true});
  const double step = width / static_cast<double>(read.columns);
  mc::PictureObject object;
  for (std::size_t row = 0; row < read.rows; ++row)
    for (std::size_t column = 0; column < read.columns; ++column) {
      const double value = read.values[row * read.columns + column];
      if (!(value > 0)) continue;
      object.place.push_back(
          {step * (static_cast<double>(column) - (static_cast<double>(read.columns) - 1) / 2),
           depth, step * (static_cast<double>(row) - (static_cast<double>(read.rows) - 1) / 2)});
      object.brightness.push_back(value);
    }
  if (object.place.empty()) throw InputError("object_picture", path, "has no pixel above 0");
  return object;
}

/// Returns the points of a disc, on a square grid.
mc::PictureObject disc_points(const Keys& keys, const ImageKeys& values, const Domain& box,
                              double wavelength) {
  const double diameter = keys.required(values.space.object_disc),
               depth = depth_of_plane(keys, values),
               distance = values.object_depth.empty() ? 1 : std::max(-depth, depth - box.depth),
               grain = wavelength * distance / std::min(box.width, box.height),
               step = keys.read(values.space.object_spacing).value_or(grain);
  if (!(diameter / step < std::sqrt(static_cast<double>(most_points))))
    throw InputError("object_spacing", step,
                     "must be above " + std::to_string(diameter / std::sqrt(double{most_points})) +
                         " for a disc of this diameter");
  mc::PictureObject object;
  const auto half = static_cast<long>(diameter / 2 / step);
  for (long j = -half; j <= half; ++j)
    for (long i = -half; i <= half; ++i)
      if (const double x = step * static_cast<double>(i), y = step * static_cast<double>(j);
          std::hypot(x, y) <= diameter / 2)
        object.place.push_back({x, depth, y});
  object.brightness.assign(object.place.size(), 1);
  return object;
}

mc::PictureObject picture_object(const Keys& keys, const ImageKeys& values, const Domain& box,
                                 double wavelength) {
  const int given = !values.object_x.empty() + !values.space.object_picture.empty() +
                    values.space.object_disc.has_value();
  if (given != 1) throw InputError("object_x, object_picture, object_disc: give one of them");
  mc::PictureObject object = !values.object_x.empty()   ? points_of(keys, values)
                             : values.space.object_disc ? disc_points(keys, values, box, wavelength)
                                                        : picture_points(keys, values);
  object.far = values.object_depth.empty();
  const double scale = keys.read(values.object_scale);
  for (Vec& place : object.place) place.x *= scale, place.y *= scale;
  if (object.place.size() > most_points)
    throw InputError("object_picture", values.space.object_picture,
                     "has " + std::to_string(object.place.size()) + " pixels above 0, at most " +
                         std::to_string(most_points) + " are allowed");
  return object;
}

FarCamera far_camera(const Keys& keys, const ImageKeys& values) {
  constexpr std::int64_t fewest = 64;
  const std::int64_t pixels = keys.required(values.spec.camera_pixels);
  if (pixels < fewest) throw InputError("camera_pixels", pixels, "must be at least 64");
  return {{0, 1, 0}, keys.required(values.spec.camera_aperture), static_cast<std::size_t>(pixels)};
}

/// Returns the times within the exposure at which the fields of a moving medium are computed.
mc::FieldChanges exposure_of(const Keys& keys, const ImageKeys& values) {
  const auto& exposure = keys.read(values.space.moving.delays);
  if (exposure.empty()) return {};
  if (!values.object_depth.empty() || values.method == "wave")
    throw InputError("exposure", exposure.front(),
                     "requires an object at infinity (no object_depth) and method = paths");
  const auto dynamics =
      mc::make_dynamics(keys, values.space.moving, values.spec, length_unit(keys));
  const auto steps = static_cast<std::size_t>(keys.read(values.space.exposure_steps));
  mc::FieldChanges changes{{}, dynamics.motion, {}, dynamics.diffusion.has_value()};
  for (std::size_t i = 0; i < steps; ++i)
    changes.delays.push_back(dynamics.delays.front() * (static_cast<double>(i) + 0.5) /
                             static_cast<double>(steps));
  return changes;
}

/// Returns the side of the recovered pictures, in pixels.
std::size_t lags_of(const Keys& keys, const ImageKeys& values, const mc::PictureScene& scene) {
  const double grain = static_cast<double>(scene.camera().pixels) / std::sqrt(scene.grains()),
               extent = keys.read(values.object_extent).value_or(mc::extent_of(scene.object)),
               lags = std::ceil(1.25 * extent * mc::picture_scale(scene) + 3 * grain),
               most = static_cast<double>(scene.camera().pixels) / 4;
  if (!(lags <= most))
    throw InputError("object_extent", extent,
                     "corresponds to " + number_text(lags) +
                         " pixels, more than a quarter of the camera's pixels; reduce it");
  return static_cast<std::size_t>(std::max(lags, 8.0));
}

mc::PictureTask picture_task(const Keys& keys, const ImageKeys& values) {
  mc::PictureTask task;
  task.repeats = static_cast<std::uint64_t>(keys.read(values.repeats));
  task.average = static_cast<std::uint64_t>(keys.read(values.average));
  read_camera_keys(keys, values.noise, task.noise);
  task.noise.background = keys.read(values.noise.background);
  task.detector = mc::detector_of(keys, values.space.detector, task.noise);
  task.phases = mc::phase_task(keys, values.space.phases);
  task.least_similarity = keys.read(values.space.least_similarity);
  task.prediction_paths = prediction_paths(keys, values);
  task.draws = static_cast<std::uint64_t>(keys.read(values.space.prediction_draws));
  return task;
}

void check_picture_memory(const mc::PictureScene& scene, const mc::PictureTask& task,
                          const std::string& method) {
  const auto pixels = static_cast<double>(scene.scene.request.views.size()),
             channels = pixels * static_cast<double>(scene.object.place.size());
  const auto media = static_cast<double>(task.repeats * task.average);
  const double at_once = 56 * channels * static_cast<double>(task.exposure.count()),
               kept = sizeof(double) * pixels * media +
                      (method == "wave" ? sizeof(Complex) * channels * media : 0);
  const double bytes = at_once * task.threads + kept;
  if (bytes > 0.8 * usable_memory())
    throw InputError("camera_pixels", scene.camera().pixels,
                     "frames and fields need " + std::to_string(bytes / 1e9) +
                         " GB of memory; reduce pixels, points, repeats or threads");
}

void print_pictures_summary(const mc::PictureScene& scene, const mc::PictureTask& task,
                            const mc::PictureResult& result) {
  const auto& speckle = result.speckle;
  std::printf("%zu points, %.0f grains of %.2f pixels; pictures of %zu x %zu pixels\n",
              scene.object.place.size(), scene.grains(), speckle.grain(), task.lags, task.lags);
  const double extent = mc::extent_of(scene.object);
  std::printf("C_I at the object's extent of %.4g: %.3f; ", extent, speckle.correlation_at(extent));
  if (const auto view = speckle.field_of_view())
    std::printf("field of view %.4g\n", *view);
  else
    std::printf("field of view above %.4g\n", speckle.separation.back());
  if (!result.pictures.empty()) {
    std::printf("%-8s %-9s %-10s %-10s %s\n", "picture", "contrast", "saturated", "agreement",
                "similarity");
    for (std::size_t i = 0; i < result.pictures.size(); ++i) {
      const auto& one = result.pictures[i];
      std::printf("%-8zu %-9.4f %-10.2g %-10.3f %.3f\n", i, one.light_contrast, one.saturated,
                  one.retrieved.agreement, one.score.similarity);
    }
    const auto [rate, error] = result.success(task.least_similarity);
    std::printf("similarity above %.3g in %.3g +- %.2g of the pictures\n", task.least_similarity,
                rate, error);
  }
  if (task.draws > 0)
    std::printf("expected: similarity %.3f +- %.2g, above %.3g with probability %.3g\n",
                result.prediction.similarity, result.prediction.similarity_error,
                task.least_similarity, result.prediction.success);
}

struct PictureFields {
  mc::FieldDraw draw;
  std::string how;
  std::uint64_t paths = 0;  ///< light paths of each medium; 0 without paths
};

PictureFields picture_fields_of(const PictureRun& run) {
  const mc::PictureTask& task = run.task;
  if (task.repeats == 0) return {{}, "prediction only, without frames"};
  if (run.method == "wave")
    return {exact_fields(run.scene.scene, task.repeats * task.average, task.seed, task.threads,
                         run.wave_tolerance),
            "wave: placements by the exact solver, minus their mean field"};
  const auto paths = run.paths_per_field
                         ? static_cast<std::uint64_t>(*run.paths_per_field)
                         : mc::paths_for_pictures(run.scene, task.seed, task.threads);
  return {mc::picture_fields(run.scene, task, paths),
          "mc: fields of " + std::to_string(paths) + " light paths", paths};
}

/// Prints what the frames need. Their time is estimated from the difference between fields of few
/// paths and of three times as many.
void print_frames_plan(const PictureRun& run, std::uint64_t paths) {
  const mc::PictureTask& task = run.task;
  if (paths == 0) return;
  const std::uint64_t media = task.repeats * task.average,
                      few = std::max<std::uint64_t>(paths / 100, 16);
  std::vector<Complex> field(task.exposure.count() * run.scene.scene.request.channels.size());
  const auto seconds_for = [&](std::uint64_t some) {
    const auto start = std::chrono::steady_clock::now();
    mc::picture_fields(run.scene, task, some)(0, field, {});
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  seconds_for(few);  // brings memory and tables into use
  const double least = seconds_for(few), rise = (seconds_for(3 * few) - least) / 2,
               each = least +
                      std::max(rise, 0.0) * static_cast<double>(paths) / static_cast<double>(few),
               rounds = std::ceil(static_cast<double>(task.repeats) / task.threads) *
                        static_cast<double>(task.average);
  std::printf(
      "%zu points, %zu pixels, %llu light paths each of %llu media: fields in about %.2g s "
      "(%.2g s a medium and thread), before phase retrieval\n",
      run.scene.object.place.size(), run.scene.scene.request.views.size(),
      static_cast<unsigned long long>(paths), static_cast<unsigned long long>(media), rounds * each,
      each);
  std::fflush(stdout);
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

}  // namespace

mc::FieldDraw exact_fields(const Scene& scene, std::uint64_t media, std::uint64_t seed, int threads,
                           double tolerance) {
  const BatchJob exact = wave_estimation(scene, tolerance, seed).job.batches;
  const std::size_t channels = scene.request.channels.size();
  const auto fields = std::make_shared<std::vector<Complex>>(media * channels);
  BatchJob job;
  job.size = 1;
  job.run = [&](std::uint64_t number, std::span<Complex>) {
    std::vector<Complex> sums(exact.size);
    exact.run(number, sums);
    std::copy_n(sums.begin(), channels, fields->begin() + static_cast<long>(number * channels));
  };
  RunState state;
  run_to_end(job, {{media, std::nullopt, std::nullopt}, threads, "wave", {}}, state);
  remove_mean(*fields, channels);
  return [fields, channels](std::uint64_t number, std::span<Complex> field, std::span<double>) {
    std::copy_n(fields->begin() + static_cast<long>(number * channels), channels, field.begin());
  };
}

PictureRun picture_run(const Keys& keys, const ImageKeys& values, std::uint64_t seed, int threads) {
  PictureRun run;
  run.method = keys.read(values.method);
  if (run.method == "wave")
    run.wave_tolerance = keys.read(values.estimation.wave_tolerance);
  else
    run.paths_per_field = keys.read(values.paths_per_field);
  keys.read(values.spec.dimension);
  run.task = picture_task(keys, values);
  run.task.seed = seed;
  run.task.threads = threads;
  if (run.method == "wave" && run.task.repeats * run.task.average < 2)
    throw InputError("repeats", run.task.repeats,
                     "repeats times average must be at least 2 with method = wave, which "
                     "subtracts the mean field of all media");
  const FarCamera camera = far_camera(keys, values);
  const Domain box{Domain::Kind::box, keys.read(values.spec.width).value_or(1),
                   keys.read(values.spec.depth).value_or(0),
                   keys.read(values.spec.height).value_or(1)};
  mc::PictureObject object = picture_object(keys, values, box, values.spec.wavelength);
  keys.read(values.object_extent);
  run.task.exposure = exposure_of(keys, values);
  Scene medium = with_dimension(make_scene(keys, values.spec), values.spec);
  if (medium.domain.kind == Domain::Kind::slab) throw InputError("domain", "slab", "must be box");
  mc::check_delays(medium, run.task.exposure.delays, run.task.exposure.motion);
  if (medium.faces && (!run.task.exposure.delays.empty() || run.method == "wave"))
    throw InputError("medium_index", medium.faces->inside,
                     "requires a medium at rest (no exposure) and method = paths");
  run.scene = mc::picture_scene(std::move(medium), std::move(object), camera);
  run.task.lags = lags_of(keys, values, run.scene);
  check_picture_memory(run.scene, run.task, run.method);
  return run;
}

Made make_pictures(ResultFile& file, const PictureRun& run, bool prints) {
  const mc::PictureScene& scene = run.scene;
  const mc::PictureTask& task = run.task;
  mc::PictureResult result;
  result.speckle = mc::predicted_speckle(scene, task);
  const double grain = result.speckle.grain();
  result.truth = mc::true_picture(scene, task.lags, mc::point_width_of(grain));
  const PictureFields fields = picture_fields_of(run);
  if (prints) print_frames_plan(run, fields.paths);
  result.pictures = mc::simulated_pictures(scene, task, fields.draw, result.truth, grain);
  if (task.draws > 0)
    result.prediction = mc::predicted_pictures(scene, task, result.speckle, result.truth);
  write_medium(file, scene.scene);
  mc::write_simulated(file, scene, task, result);
  check_power(file, "", scene.scene,
              {"mc", static_cast<double>(task.prediction_paths), 0, task.seed});
  if (prints) print_pictures_summary(scene, task, result);
  return Made{fields.how, static_cast<double>(task.repeats * task.average)};
}

}  // namespace flatspeckle::apps
