#include "mc/imaging/blinking.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/run/runner.h"
#include "flatland/request/request.h"
#include "mc/imaging/imaging.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// Returns the seed of the excitation, whose random numbers are independent of those of the fields
/// and the camera.
std::uint64_t seed_of_excitation(std::uint64_t seed) {
  return seed ^ 0x9e3779b97f4a7c15U;
}

/// Returns a request for the light that a plane wave, incident on the opposite side of the box,
/// sends to the points of the object.
CovarianceRequest at_points(const LineScene& line) {
  const Lights light{plane_wave(line.object_depth < 0 ? std::numbers::pi : 0)};
  std::vector<View> views;
  for (const double x : line.object.x) views.push_back(near_sensor({x, line.object_depth}));
  return full_request(light, std::move(views));
}

std::vector<double> correlations(std::span<const Complex> lower, std::size_t points) {
  std::vector<double> pairs;
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = i + 1; j < points; ++j)
      pairs.push_back(std::norm(lower[triangle_entry(j, i)]) /
                      (lower[triangle_entry(i, i)].real() * lower[triangle_entry(j, j)].real()));
  return pairs;
}

BrightnessDraw brightness_by(const FieldDraw& fields, std::size_t frames, std::size_t points,
                             double mean) {
  return [=](std::uint64_t medium) {
    std::vector<double> brightness(frames * points);
    std::vector<Complex> field(points);
    std::vector<double> intensity(points);
    for (std::size_t f = 0; f < frames; ++f) {
      fields(medium * frames + f, field, intensity);
      for (std::size_t n = 0; n < points; ++n)
        brightness[f * points + n] = std::norm(field[n]) / mean;
    }
    return brightness;
  };
}

std::vector<double> brightness_in(const LineScene& line, std::span<const double> factors) {
  std::vector<double> brightness = line.object.brightness;
  for (std::size_t n = 0; n < brightness.size(); ++n) brightness[n] *= factors[n];
  return brightness;
}

/// Divides all frames by their common mean.
void scale(std::vector<std::vector<double>>& frames) {
  double sum = 0;
  for (const auto& frame : frames)
    for (const double value : frame) sum += value;
  const double mean = sum / static_cast<double>(frames.size() * frames.front().size());
  if (mean > 0)
    for (auto& frame : frames)
      for (double& value : frame) value /= mean;
}

std::vector<std::vector<double>> light_of(const LineScene& line, std::span<const Complex> field,
                                          const Blinked& made, std::size_t count) {
  const std::size_t points = line.object.x.size();
  std::vector<std::vector<double>> frames;
  for (std::size_t f = 0; f < count; ++f)
    frames.push_back(sum_of_intensities(
        field, brightness_in(line, std::span(made.brightness).subspan(f * points, points))));
  scale(frames);
  return frames;
}

/// Sets the measured and the expected squared contrast, averaged over the frames with light, before
/// camera noise.
void note_contrast(Blinked& made, const LineScene& line) {
  const std::size_t points = line.object.x.size();
  double lit = 0;
  for (std::size_t f = 0; f < made.frames.size(); ++f) {
    const LineObject object{
        line.object.x, brightness_in(line, std::span(made.brightness).subspan(f * points, points))};
    double sum = 0, squares = 0;
    for (const double b : object.brightness) {
      sum += b;
      squares += b * b;
    }
    if (sum == 0) continue;
    made.square += squared_contrast(made.frames[f]);
    made.expected_square += squares / (sum * sum);
    ++lit;
  }
  made.square /= std::max(lit, 1.0);
  made.expected_square /= std::max(lit, 1.0);
}

double correlation(std::span<const Complex> field, const Eigen::MatrixXd& patterns,
                   Eigen::Index source) {
  Eigen::VectorXd intensity(static_cast<Eigen::Index>(field.size()));
  for (Eigen::Index p = 0; p < intensity.size(); ++p)
    intensity[p] = std::norm(field[static_cast<std::size_t>(p)]);
  const Eigen::VectorXd a = (intensity.array() - intensity.mean()).matrix(),
                        b = (patterns.col(source).array() - patterns.col(source).mean()).matrix();
  const double squares = a.squaredNorm() * b.squaredNorm();
  return squares > 0 ? a.dot(b) / std::sqrt(squares) : 0;
}

std::vector<double> matches(const LineScene& line, std::span<const Complex> field,
                            const Eigen::MatrixXd& patterns) {
  std::vector<double> best(line.object.x.size());
  for (std::size_t n = 0; n < best.size(); ++n)
    for (Eigen::Index s = 0; s < patterns.cols(); ++s)
      best[n] = std::max(
          best[n],
          correlation(field.subspan(n * line.camera.pixels, line.camera.pixels), patterns, s));
  return best;
}

}  // namespace

BrightnessDraw random_subsets(std::size_t frames, std::size_t points, double lit,
                              std::uint64_t seed) {
  return [=](std::uint64_t medium) {
    RandomStream random(seed_of_excitation(seed), static_cast<std::uint64_t>(Stream::camera),
                        medium);
    std::vector<double> brightness(frames * points);
    for (double& each : brightness) each = random.uniform() < lit ? 1 : 0;
    return brightness;
  };
}

Excitation speckle_excitation(Scene medium, const LineScene& line, const ExcitationTask& task) {
  medium.request = at_points(line);
  const std::uint64_t seed = seed_of_excitation(task.seed);
  const FieldJob job = covariance_job(medium, make_plan(medium, ReversedPaths::automatic), seed);
  RunState state;
  run_to_end(job.batches,
             {{task.paths, std::nullopt, std::nullopt}, task.threads, "excitation", {}}, state);
  const std::size_t points = line.object.x.size();
  const auto lower = job.covariance(state.sums.total_samples(), state.sums.total());
  CovarianceFactor factor(points, lower);
  double mean = 0;
  for (std::size_t n = 0; n < points; ++n) mean += factor.variance(n) / static_cast<double>(points);
  return {brightness_by(fields_from_covariance(std::move(factor), seed), task.frames, points, mean),
          correlations(lower, points)};
}

Blinked blinked(const LineScene& line, const BlinkingTask& task, std::span<const Complex> field,
                std::uint64_t medium, std::uint64_t seed) {
  Blinked made;
  made.brightness = task.draw(medium);
  made.frames = light_of(line, field, made, task.frames);
  note_contrast(made, line);
  for (std::size_t f = 0; f < task.frames; ++f) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::camera), medium * task.frames + f);
    expose(made.frames[f], task.separation.noise, random);
  }
  if (!task.separates) return made;
  made.found = separated_sources(made.frames, task.separation);
  made.pattern_match = matches(line, field, made.found.factors.pattern);
  made.score = score(shifts(line), made.found.object(),
                     task.separation.resolution_grains * made.found.grain, MirrorImage::no);
  return made;
}

std::vector<double> mean_frame(const std::vector<std::vector<double>>& frames) {
  std::vector<double> mean(frames.front().size());
  for (const auto& frame : frames)
    for (std::size_t p = 0; p < mean.size(); ++p)
      mean[p] += frame[p] / static_cast<double>(frames.size());
  return mean;
}

CameraNoise noise_of_mean(const CameraNoise& noise, std::size_t frames) {
  const auto count = static_cast<double>(frames);
  return {noise.photons * count, noise.read_noise * std::sqrt(count), noise.background};
}

}  // namespace flatspeckle::mc
