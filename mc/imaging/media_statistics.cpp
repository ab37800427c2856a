#include "mc/imaging/media_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mc/imaging/success_prediction.h"

namespace flatspeckle::mc {

namespace {

double power_sum(const LineObject& object, int power) {
  double sum = 0;
  for (const double b : object.brightness) sum += std::pow(b, power);
  return sum;
}

}  // namespace

MeanOverMedia mean_over(const std::vector<ImagedMedium>& media, double error_of_one,
                        const std::function<double(const ImagedMedium&)>& of) {
  const auto n = static_cast<double>(media.size());
  double sum = 0, squares = 0;
  for (const ImagedMedium& medium : media) {
    sum += of(medium) / n;
    squares += of(medium) * of(medium) / n;
  }
  if (media.size() == 1) return {sum, error_of_one};
  return {sum, std::sqrt(std::max(squares - sum * sum, 0.0) / (n - 1))};
}

MeanOverMedia share_of(const std::vector<ImagedMedium>& media,
                       const std::function<bool(const ImagedMedium&)>& holds) {
  const auto found = static_cast<double>(std::count_if(media.begin(), media.end(), holds)),
             n = static_cast<double>(media.size()), likely = (found + 1) / (n + 2);
  return {found / n, std::sqrt(likely * (1 - likely) / (n + 3))};
}

MeanOverMedia root_of(const MeanOverMedia& square) {
  const double root = std::sqrt(std::max(square.value, 0.0));
  return {root, root > 0 ? square.error / (2 * root) : 0};
}

double mean_grains(const std::vector<ImagedMedium>& media) {
  return mean_over(media, 0, [](const ImagedMedium& m) { return m.statistics.grains; }).value;
}

FrameGrains frame_grains(const LineScene& line, const ImagingTask& task) {
  const auto frames = static_cast<double>(task.average);
  constexpr double of_speckle = 1.5;  // grains over what a triangle as its spectrum is wide
  return {of_speckle * most_grains(line) * frames, task.recovery.noise,
          static_cast<double>(line.camera.pixels) * frames};
}

double gaussian_contrast(const LineObject& object, double background) {
  return std::sqrt(power_sum(object, 2)) / power_sum(object, 1) / (1 + background);
}

MeanOverMedia mean_contrast(const LineObject& object, const std::vector<ImagedMedium>& media) {
  const double two = power_sum(object, 2), four = 6 * power_sum(object, 4);
  const double relative = std::sqrt((2 + four / (two * two)) / mean_grains(media));
  return root_of(mean_over(media, relative * media.front().statistics.square,
                           [](const ImagedMedium& m) { return m.statistics.square; }));
}

MeanOverMedia mean_fourth_moment(const std::vector<ImagedMedium>& media) {
  constexpr double eight = 2 + 6;  // 2 kappa_2^2 + kappa_4 of one point
  return mean_over(media, std::sqrt(eight / mean_grains(media)),
                   [](const ImagedMedium& m) { return m.fourth_moment; });
}

MeanOverMedia success_rate(const std::vector<ImagedMedium>& media) {
  return share_of(media, [](const ImagedMedium& medium) { return medium.score.found == 1; });
}

ExpectedPeaks expected_peaks(const LineScene& line, const ImagingTask& task,
                             const ImagingPrediction& prediction) {
  const FrameGrains frame = frame_grains(line, task);
  ExpectedPeaks expected;
  expected.signals = peaks_over_noise(line.object, real_parts(prediction.correlation.value), frame);
  const std::size_t points = line.object.x.size();
  if (points < 2 || task.recovery.points != points) return expected;
  const double band = most_grains(line) / static_cast<double>(line.camera.pixels),
               places = band * static_cast<double>(task.recovery.lags);
  const auto searched =
      filtered_peaks_over_noise(line.object, real_parts(prediction.correlation.value), frame, band);
  expected.success =
      predicted_success(searched, points, places, task.recovery.memory_range > 0, line.object.x);
  return expected;
}

std::size_t alike_pairs(const LineScene& line, double grains) {
  const LineObject at = shifts(line);
  std::vector<double> distances;
  for (std::size_t i = 0; i < at.x.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) distances.push_back(std::abs(at.x[i] - at.x[j]));
  std::sort(distances.begin(), distances.end());
  const double grain = static_cast<double>(line.camera.pixels) / most_grains(line) * 2 / 3;
  std::size_t alike = 0;
  for (std::size_t i = 1; i < distances.size(); ++i)
    alike += distances[i] - distances[i - 1] < grains * grain;
  return alike;
}

MeanOverMedia mean_psnr(const std::vector<ImagedMedium>& media) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  return mean_over(media, unknown, [](const ImagedMedium& m) { return m.psnr; });
}

}  // namespace flatspeckle::mc
