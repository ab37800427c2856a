#include "mc/imaging/imaging.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/run/interrupt.h"
#include "mc/estimators/covariance_estimator.h"
#include "mc/imaging/camera_frame.h"
#include "mc/speckle/field_plan.h"

namespace flatspeckle::mc {

namespace {

/// Whether it ran to its end.
bool run(const BatchJob& job, std::uint64_t samples, int threads, const char* label,
         RunState& state) {
  run_batches(job, {{samples, std::nullopt, std::nullopt}, threads, label, {}}, state);
  return !interrupted();
}

LineObject scaled(LineObject object, double factor) {
  for (double& x : object.x) x *= factor;
  return object;
}

/// Of |u|^2 over its smooth envelope, all points together.
double fourth_moment(std::span<const Complex> field, std::size_t points) {
  const std::size_t pixels = field.size() / points;
  std::vector<double> intensity(pixels);
  double sum = 0;
  for (std::size_t n = 0; n < points; ++n) {
    for (std::size_t p = 0; p < pixels; ++p) intensity[p] = std::norm(field[n * pixels + p]);
    sum += squared_contrast(intensity);
  }
  return 1 + sum / static_cast<double>(points);
}

ImagedMedium imaged_one(const LineScene& line, const ImagingTask& task, const FieldDraw& draw,
                        std::uint64_t number) {
  const std::size_t channels = line.scene.request.channels.size();
  std::vector<Complex> field(channels);
  std::vector<double> intensity(channels);
  draw(number, field, intensity);
  ImagedMedium medium;
  medium.frame = incoherent_sum(field, line.object.brightness);
  medium.fourth_moment = fourth_moment(field, line.object.x.size());
  RandomStream random(task.seed, static_cast<std::uint64_t>(Stream::camera), number);
  expose(medium.frame, task.recovery.noise, random);
  static_cast<Recovered&>(medium) = recovered(medium.frame, task.recovery);
  if (task.recovery.points > 0)
    medium.score = score(scaled(line.object, magnification(line)), medium.fit.object,
                         task.recovery.resolution_grains * medium.statistics.grain);
  return medium;
}

/// Pairs of channels, then the intensities of either, for each place and pair.
CovarianceRequest pair_request(const LineScene& line, const std::vector<double>& places) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::pairs;
  request.lights = line.scene.request.lights;
  const double moved = magnification(line);
  const auto channel = [&](std::size_t light, double pixel) {
    request.channels.push_back(
        {static_cast<std::uint32_t>(light), static_cast<std::uint32_t>(request.views.size())});
    request.views.push_back(view_at(line.camera, pixel));
    return static_cast<std::uint32_t>(request.channels.size() - 1);
  };
  for (const double place : places)
    for (std::size_t i = 0; i < line.object.x.size(); ++i)
      for (std::size_t j = i + 1; j < line.object.x.size(); ++j) {
        const double shift = moved * (line.object.x[j] - line.object.x[i]);
        const std::uint32_t a = channel(i, place - shift / 2), b = channel(j, place + shift / 2);
        request.entries.insert(request.entries.end(), {{a, b}, {a, a}, {b, b}});
      }
  return request;
}

/// [place][pair]: mean over the places.
std::vector<Complex> mean_correlations(std::span<const Complex> entries, std::size_t places) {
  const std::size_t pairs = entries.size() / (3 * places);
  std::vector<Complex> mean(pairs);
  for (std::size_t p = 0; p < places; ++p)
    for (std::size_t i = 0; i < pairs; ++i) {
      const Complex* const of = &entries[3 * (p * pairs + i)];
      const double intensities = of[1].real() * of[2].real();
      if (intensities > 0) mean[i] += std::norm(of[0]) / intensities / static_cast<double>(places);
    }
  return mean;
}

/// Some pixels of the camera.
LineScene with_fewer_pixels(LineScene line, std::size_t most) {
  line.camera.pixels = std::min(line.camera.pixels, most);
  return line_scene(std::move(line.scene), std::move(line.object), line.object_depth, line.camera);
}

}  // namespace

std::optional<std::vector<ImagedMedium>> imaged(const LineScene& line, const ImagingTask& task,
                                                const FieldDraw& draw) {
  std::vector<ImagedMedium> media(task.repeats);
  BatchJob job;
  job.size = 1;
  job.run = [&](std::uint64_t number, std::span<Complex>) {
    // there are always two batches
    if (number < task.repeats) media[number] = imaged_one(line, task, draw, number);
  };
  RunState state;
  if (!run(job, task.repeats, task.threads, "frames", state)) return std::nullopt;
  return media;
}

std::optional<ImagingPrediction> predicted(const LineScene& line, std::uint64_t paths,
                                           std::uint64_t seed, int threads) {
  const auto middle = static_cast<double>(line.camera.pixels - 1) / 2;
  const std::vector<double> places{0.8 * middle, middle, 1.2 * middle};
  Scene scene = line.scene;
  scene.request = pair_request(line, places);
  if (scene.request.entries.empty()) return ImagingPrediction{};
  const FieldJob field = covariance_job(scene, make_plan(scene, ReversedPaths::automatic), seed);
  RunState state;
  if (!run(field.batches, paths, threads, "correlations", state)) return std::nullopt;
  ImagingPrediction prediction;
  for (std::size_t i = 0; i < line.object.x.size(); ++i)
    for (std::size_t j = i + 1; j < line.object.x.size(); ++j)
      prediction.distance.push_back(std::abs(line.object.x[j] - line.object.x[i]));
  prediction.correlation =
      jackknife(state.sums, [&, covariance = field.covariance, count = places.size()](
                                double samples, std::span<const Complex> sums) {
        return mean_correlations(covariance(samples, sums), count);
      });
  return prediction;
}

std::vector<double> peaks_over_noise(const LineObject& object,
                                     const std::vector<double>& correlation, double grains) {
  const std::vector<double>& b = object.brightness;
  const double alone = std::inner_product(b.begin(), b.end(), b.begin(), 0.0);  // times (sum b)^2
  std::vector<double> peaks;
  for (std::size_t i = 0; i < b.size(); ++i)
    for (std::size_t j = i + 1; j < b.size(); ++j)
      peaks.push_back(correlation[peaks.size()] * b[i] * b[j]);
  const double squares = std::inner_product(peaks.begin(), peaks.end(), peaks.begin(), 0.0),
               noise = std::sqrt((alone * alone + 2 * squares) / grains);
  for (double& peak : peaks) peak /= noise;
  return peaks;
}

std::optional<std::uint64_t> paths_for_fields(const LineScene& line, std::uint64_t seed,
                                              int threads) {
  const LineScene some = with_fewer_pixels(line, 64);
  const Plan plan = make_plan(some.scene, ReversedPaths::automatic);
  RunState state;
  if (!run(survey_job(some.scene, plan, seed), survey_paths, threads, "survey", state))
    return std::nullopt;
  FieldDemand demand;
  demand.method = FieldMethod::paths;
  demand.fields = 1;
  const FieldPlan plan_of_some = make_field_plan(some.scene, read_survey(state.sums), demand);
  return std::max(plan_of_some.paths_per_field, static_cast<std::uint64_t>(2 * most_grains(line)));
}

}  // namespace flatspeckle::mc
