#include "mc/imaging/blinking.h"

#include <algorithm>
#include <cmath>

#include "mc/imaging/camera_frame.h"
#include "mc/imaging/recovery/frame_statistics.h"

namespace flatspeckle::mc {

namespace {

std::vector<double> brightness_in(const LineScene& line, std::span<const double> factors) {
  std::vector<double> brightness = line.object.brightness;
  for (std::size_t n = 0; n < brightness.size(); ++n) brightness[n] *= factors[n];
  return brightness;
}

/// Over the mean of all.
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

/// Over the frames with light, before the camera.
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

Blinked blinked(const LineScene& line, const BlinkingTask& task, std::span<const Complex> field,
                std::uint64_t medium, std::uint64_t seed) {
  Blinked made;
  made.brightness = task.draw(medium);
  made.frames = light_of(line, field, made, task.frames);
  note_contrast(made, line);
  for (std::size_t f = 0; f < task.frames; ++f) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::camera), medium * task.frames + f);
    expose(made.frames[f], task.unmixing.noise, random);
  }
  if (!task.unmixes) return made;
  made.found = unmixed(made.frames, task.unmixing);
  made.pattern_match = matches(line, field, made.found.factors.pattern);
  made.score = score(shifts(line), made.found.object(),
                     task.unmixing.resolution_grains * made.found.grain, MirrorImage::no);
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
