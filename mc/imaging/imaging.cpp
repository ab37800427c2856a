#include "mc/imaging/imaging.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/run/runner.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/field_plan.h"

namespace flatspeckle::mc {

namespace {

/// Expected heights of the peaks in an autocorrelation without noise, with the symbols of
/// peaks_over_noise(): a_ij of all pairs, a_0, and 2 sum of a_ij^2.
struct Peaks {
  std::vector<double> pairs;
  double alone = 0, squares = 0;

  Peaks(const LineObject& object, const std::vector<double>& correlation, double background) {
    const std::vector<double>& b = object.brightness;
    const double all = std::reduce(b.begin(), b.end()) * (1 + background);
    alone = std::inner_product(b.begin(), b.end(), b.begin(), 0.0) / (all * all);
    for (std::size_t i = 0; i < b.size(); ++i)
      for (std::size_t j = i + 1; j < b.size(); ++j)
        pairs.push_back(correlation[pairs.size()] * b[i] * b[j] / (all * all));
    squares = 2 * std::inner_product(pairs.begin(), pairs.end(), pairs.begin(), 0.0);
  }
};

std::vector<double> over(std::vector<double> peaks, double variance) {
  for (double& peak : peaks) peak /= std::sqrt(variance);
  return peaks;
}

RunState run(const BatchJob& job, std::uint64_t samples, int threads, const char* label) {
  RunState state;
  run_to_end(job, {{samples, std::nullopt, std::nullopt}, threads, label, {}}, state);
  return state;
}

/// Returns E|u|^4 / (E|u|^2)^2, averaged over the points, where |u|^2 is divided by its smooth
/// envelope.
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

/// Camera frames of one medium.
struct ExposedFrames {
  std::vector<double> frame, reference;
  double fourth_moment = 0;
  Blinked blinked;
};

ExposedFrames exposed(const LineScene& line, const ImagingTask& task, const FieldDraw& draw,
                      std::uint64_t number) {
  const std::size_t channels = line.scene.request.channels.size();
  std::vector<Complex> field(channels);
  std::vector<double> intensity(channels);
  draw(number, field, intensity);
  ExposedFrames made;
  const std::size_t of_object = line.object.x.size() * line.camera.pixels;
  made.fourth_moment = fourth_moment(field, line.scene.request.lights.size());
  if (task.blinking.draw) {
    made.blinked = blinked(line, task.blinking, field, number, task.seed);
    made.frame = mean_frame(made.blinked.frames);
    return made;
  }
  made.frame = incoherent_sum(std::span(field).first(of_object), line.object.brightness);
  RandomStream random(task.seed, static_cast<std::uint64_t>(Stream::camera), number);
  expose(made.frame, task.recovery.noise, random);
  if (!line.reference) return made;
  const std::vector<double> one{1};
  made.reference = incoherent_sum(std::span(field).subspan(of_object), one);
  expose(made.reference, task.recovery.noise, random);
  return made;
}

void divide_by_reference(ImagedMedium& medium, const LineScene& line, const ImagingTask& task) {
  const std::size_t lags = task.recovery.lags;
  medium.deconvolved = deconvolved(medium.frame, medium.reference, lags, task.deconvolution);
  medium.psnr =
      psnr(point_picture(shifts(line), lags, medium.deconvolved.grain), medium.deconvolved.picture);
}

/// Releases the memory of the frames and patterns.
void drop_frames(Blinked& blinked) {
  blinked.frames.clear();
  blinked.found.factors.pattern.resize(0, 0);
}

ImagedMedium imaged_one(const LineScene& line, const ImagingTask& task, const FieldDraw& draw,
                        std::uint64_t number) {
  ImagedMedium medium;
  std::vector<std::vector<double>> frames;
  for (std::uint64_t i = 0; i < task.average; ++i) {
    ExposedFrames made = exposed(line, task, draw, number * task.average + i);
    frames.push_back(std::move(made.frame));
    medium.reference = std::move(made.reference);
    medium.fourth_moment += made.fourth_moment / static_cast<double>(task.average);
    medium.blinked = std::move(made.blinked);
  }
  static_cast<Recovered&>(medium) = recovered(frames, task.recovery);
  medium.frame = std::move(frames.front());
  if (number > 0) drop_frames(medium.blinked);
  if (line.reference) divide_by_reference(medium, line, task);
  if (task.recovery.points > 0)
    medium.score = score(shifts(line), medium.fit.object,
                         task.recovery.resolution_grains * medium.statistics.grain);
  return medium;
}

/// Pairs of points (0, 1), (0, 2), ..., then pairs of each point with the reference, by index.
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
Pairs pairs_of(const LineScene& line) {
  const std::size_t points = line.object.x.size();
  Pairs pairs;
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = i + 1; j < points; ++j) pairs.emplace_back(i, j);
  if (line.reference)
    for (std::size_t i = 0; i < points; ++i) pairs.emplace_back(i, points);
  return pairs;
}

/// Returns the positions x of both points of a pair.
std::pair<double, double> places_of(const LineScene& line,
                                    std::pair<std::size_t, std::size_t> pair) {
  std::vector<double> x = line.object.x;
  if (line.reference) x.push_back(*line.reference);
  return {x[pair.first], x[pair.second]};
}

/// Returns a request with three entries for each position on the camera and each pair of points:
/// the covariance of the two channels, then their two intensities. places: positions as fractional
/// pixels.
CovarianceRequest pair_request(const LineScene& line, const Pairs& pairs,
                               const std::vector<double>& places) {
  CovarianceRequest request;
  request.kind = CovarianceRequest::Kind::pairs;
  request.lights = line.scene.request.lights;
  const auto channel = [&](std::size_t light, double pixel) {
    request.channels.push_back(
        {static_cast<std::uint32_t>(light), static_cast<std::uint32_t>(request.views.size())});
    request.views.push_back(view_at(line.camera, pixel));
    return static_cast<std::uint32_t>(request.channels.size() - 1);
  };
  for (const double place : places)
    for (const auto& pair : pairs) {
      const auto [x, other] = places_of(line, pair);
      const double shift = shift_of(line, other) - shift_of(line, x);
      const std::uint32_t a = channel(pair.first, place - shift / 2),
                          b = channel(pair.second, place + shift / 2);
      request.entries.insert(request.entries.end(), {{a, b}, {a, a}, {b, b}});
    }
  return request;
}

/// Returns the scene with at most `most` pixels.
LineScene with_fewer_pixels(LineScene line, std::size_t most) {
  line.camera.pixels = std::min(line.camera.pixels, most);
  return line_scene(std::move(line.scene), std::move(line.object), line.object_depth, line.camera,
                    line.reference);
}

}  // namespace

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

std::vector<double> sum_of_intensities(std::span<const Complex> field,
                                       std::span<const double> brightness) {
  const std::size_t pixels = field.size() / brightness.size();
  std::vector<double> frame(pixels);
  for (std::size_t n = 0; n < brightness.size(); ++n)
    for (std::size_t p = 0; p < pixels; ++p)
      frame[p] += brightness[n] * std::norm(field[n * pixels + p]);
  return frame;
}

std::vector<double> incoherent_sum(std::span<const Complex> field,
                                   std::span<const double> brightness) {
  auto frame = sum_of_intensities(field, brightness);
  const double mean = std::reduce(frame.begin(), frame.end()) / static_cast<double>(frame.size());
  if (mean > 0)
    for (double& value : frame) value /= mean;
  return frame;
}

std::vector<double> peaks_over_noise(const LineObject& object,
                                     const std::vector<double>& correlation,
                                     const FrameGrains& frame) {
  const Peaks peaks(object, correlation, frame.noise.background);
  const double white = noise_variance(frame.noise);
  return over(peaks.pairs, (peaks.alone * peaks.alone + peaks.squares) / frame.grains +
                               (2 * peaks.alone + white) * white / frame.pixels);
}

std::vector<double> filtered_peaks_over_noise(const LineObject& object,
                                              const std::vector<double>& correlation,
                                              const FrameGrains& frame, double band) {
  const Peaks peaks(object, correlation, frame.noise.background);
  const double white = noise_variance(frame.noise);
  double variance = 0, kept = 0;
  constexpr int frequencies = 2000;
  for (int i = 0; i < frequencies; ++i) {
    const double speckle = speckle_power((i + 0.5) / (2 * frequencies), band);
    if (speckle == 0) continue;
    const double power = peaks.alone * speckle + white, filter = speckle / power;
    kept += filter * speckle / frequencies;
    variance += filter * filter * (power * power + peaks.squares * speckle * speckle) / frequencies;
  }
  return over(peaks.pairs, variance / (kept * kept) / frame.pixels);
}

std::vector<ImagedMedium> imaged(const LineScene& line, const ImagingTask& task,
                                 const FieldDraw& draw) {
  std::vector<ImagedMedium> media(task.repeats);
  if (media.empty()) return media;
  BatchJob job;
  job.size = 1;
  job.run = [&](std::uint64_t number, std::span<Complex>) {
    // a run has at least two batches, even for one repeat
    if (number < task.repeats) media[number] = imaged_one(line, task, draw, number);
  };
  run(job, task.repeats, task.threads, "frames");
  return media;
}

ImagingPrediction predicted(const LineScene& line, std::uint64_t paths, std::uint64_t seed,
                            int threads, const char* label) {
  const auto last = static_cast<double>(line.camera.pixels - 1);
  const std::vector<double> places{0.1 * last, 0.3 * last, 0.5 * last, 0.7 * last, 0.9 * last};
  Scene scene = line.scene;
  const Pairs pairs = pairs_of(line);
  scene.request = pair_request(line, pairs, places);
  if (scene.request.entries.empty()) return {};
  const FieldJob field = covariance_job(scene, make_plan(scene, ReversedPaths::automatic), seed);
  const RunState state = run(field.batches, paths, threads, label);
  const std::size_t of_object = pairs.size() - (line.reference ? line.object.x.size() : 0);
  ImagingPrediction prediction;
  for (std::size_t i = 0; i < of_object; ++i) {
    const auto [x, other] = places_of(line, pairs[i]);
    prediction.distance.push_back(std::abs(other - x));
  }
  const Estimate all =
      jackknife(state.sums, [&, covariance = field.covariance, count = places.size()](
                                double samples, std::span<const Complex> sums) {
        return mean_correlations(covariance(samples, sums), count);
      });
  prediction.correlation = part(all, 0, of_object);
  prediction.to_reference = part(all, of_object, pairs.size() - of_object);
  return prediction;
}

std::uint64_t paths_for_fields(const LineScene& line, std::uint64_t seed, int threads) {
  const LineScene some = with_fewer_pixels(line, 64);
  const Plan plan = make_plan(some.scene, ReversedPaths::automatic);
  const RunState state = run(survey_job(some.scene, plan, seed), survey_paths, threads, "survey");
  FieldDemand demand;
  demand.method = FieldMethod::paths;
  demand.fields = 1;
  const DrawingPlan plan_of_some = make_field_plan(some.scene, read_survey(state.sums), demand);
  return std::max(plan_of_some.paths_per_field, static_cast<std::uint64_t>(4 * most_grains(line)));
}

}  // namespace flatspeckle::mc
