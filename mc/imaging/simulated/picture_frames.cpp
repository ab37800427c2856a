#include "mc/imaging/simulated/picture_frames.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/numbers/blas.h"
#include "core/run/runner.h"
#include "mc/imaging/imaging.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/simulated/camera_products.h"
#include "mc/paths/speckle/camera_ends.h"
#include "mc/paths/speckle/camera_resolution.h"
#include "mc/paths/speckle/field_plan.h"

namespace flatspeckle::mc {

namespace {

RunState run_frames(const BatchJob& job, std::uint64_t samples, int threads, const char* label) {
  RunState state;
  run_to_end(job, {{samples, std::nullopt, std::nullopt}, threads, label, {}}, state);
  return state;
}

double contrast_of(std::span<const double> frame) {
  double squares = 0;
  for (const double value : frame) squares += (value - 1) * (value - 1);
  return std::sqrt(squares / static_cast<double>(frame.size()));
}

/// Simulates the frame of medium `number` and adds it to a picture.
void add_frame(const PictureScene& scene, const PictureTask& task, const FieldDraw& draw,
               std::uint64_t number, SimulatedPicture& made) {
  std::vector<Complex> field(task.exposure.count() * scene.scene.request.channels.size());
  draw(number, field, {});
  auto frame = incoherent_picture(field, scene.object.brightness, task.exposure.count());
  if (made.frames.values.empty()) made.light_contrast = contrast_of(frame);
  RandomStream random(task.seed, static_cast<std::uint64_t>(Stream::camera), number);
  const std::size_t saturated = detect(frame, task.noise, task.detector, random);
  made.saturated += static_cast<double>(saturated) / static_cast<double>(frame.size()) /
                    static_cast<double>(task.average);
  made.frames.values.insert(made.frames.values.end(), frame.begin(), frame.end());
}

}  // namespace

std::uint64_t paths_for_pictures(const PictureScene& scene, std::uint64_t seed, int threads) {
  const Scene some = on_coarse_camera(scene.scene);
  const Plan plan = make_plan(some, ReversedPaths::automatic);
  const RunState state = run_frames(survey_job(some, plan, seed), survey_paths, threads, "survey");
  FieldDemand demand;
  demand.method = FieldMethod::paths;
  demand.fields = 1;
  const PathSurvey survey = read_survey(state.sums);
  const double per_grain = 4 * scene.grains() / std::max(survey.contributions, 1e-3);
  return std::max(make_field_plan(some, survey, demand).paths_per_field,
                  static_cast<std::uint64_t>(per_grain));
}

FieldDraw picture_fields(const PictureScene& scene, const PictureTask& task, std::uint64_t paths) {
  const Scene some = on_coarse_camera(scene.scene);
  Plan plan = plan_for_fields(make_plan(some, ReversedPaths::automatic));
  plan.paths_per_batch = paths;
  blas_single_thread();  // must come before threads request memory from BLAS
  return [walks = path_walks(some, plan, task.seed), camera = scene.camera(), seed = task.seed,
          changes = task.exposure, lights = scene.object.place.size(),
          paths](std::uint64_t number, std::span<Complex> field, std::span<double>) {
    std::ranges::fill(field, 0);
    if (!walks) return;
    CameraProducts sums(*walks, camera, lights, changes.count());
    const RandomStream phases(seed, static_cast<std::uint64_t>(Stream::fields), number);
    each_end(*walks, number, changes, phases,
             [&](const PathEnd& end, std::span<const Complex> factors, std::size_t first) {
               sums.add(end, factors, first / lights, field);
             });
    sums.finish(field);
    const double share = 1 / std::sqrt(static_cast<double>(paths));
    std::ranges::transform(field, field.begin(), [share](Complex u) { return share * u; });
  };
}

std::vector<double> incoherent_picture(std::span<const Complex> field,
                                       std::span<const double> brightness, std::size_t changes) {
  const std::size_t of_change = field.size() / changes;
  std::vector<double> frame(of_change / brightness.size());
  for (std::size_t change = 0; change < changes; ++change) {
    const auto light = sum_of_intensities(field.subspan(change * of_change, of_change), brightness);
    std::ranges::transform(frame, light, frame.begin(), std::plus<>());
  }
  const double mean = mean_of(frame);
  if (mean > 0)
    for (double& value : frame) value /= mean;
  return frame;
}

double point_width_of(double grain) {
  return grain / std::sqrt(2.0);
}

std::vector<SimulatedPicture> simulated_pictures(const PictureScene& scene, const PictureTask& task,
                                                 const FieldDraw& draw,
                                                 const std::vector<double>& truth, double grain) {
  std::vector<SimulatedPicture> pictures(task.repeats);
  if (pictures.empty()) return pictures;
  const std::size_t pixels = scene.camera().pixels;
  BatchJob job;
  job.size = 1;
  job.run = [&](std::uint64_t number, std::span<Complex>) {
    // a run has at least two batches, even for one repeat
    if (number >= task.repeats) return;
    SimulatedPicture& made = pictures[number];
    made.frames.rows = made.frames.columns = pixels;
    for (std::uint64_t i = 0; i < task.average; ++i)
      add_frame(scene, task, draw, number * task.average + i, made);
    made.statistics = picture_statistics(made.frames, 0, task.average, task.lags, task.detected());
    made.retrieved = retrieved_picture(made.statistics.autocorrelation, task.size(), task.phases);
    made.score = picture_score(truth, made.retrieved.picture, task.size(), point_width_of(grain));
  };
  run_frames(job, task.repeats, task.threads, "frames");
  return pictures;
}

}  // namespace flatspeckle::mc
