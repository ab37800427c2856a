#include "mc/imaging/imaging_datasets.h"

#include <algorithm>
#include <cmath>

#include "core/result/result_group.h"
#include "mc/imaging/blinking_datasets.h"
#include "mc/imaging/media_statistics.h"
#include "mc/imaging/picture_datasets.h"
#include "mc/imaging/recovery/recovery_datasets.h"

namespace flatspeckle::mc {

const DatasetTable imaging_table{
    .name = "image",
    .rows = {{"camera_place", Data::scale, "", "PLACE", "pixels: x, or sines of directions"},
             {"repeat", Data::numbers, "", "1",
              "number of the medium, or of several, by the key average"},
             {"point", Data::numbers, "", "1", "number of the point of the object"},
             {"sought", Data::numbers, "", "1", "number of the point that was looked for"},
             {"pair", Data::numbers, "", "1", "number of the pair of points (0, 1), (0, 2), ..."},
             {"distance", Data::scale, "", "length", "lag of the camera in lengths of the object"},
             {"object_x", Data::real, "point", "length", "the object"},
             {"object_brightness", Data::real, "point", "1", "relative"},
             {"frame", Data::real, "repeat camera_place", "1",
              "of the first medium, in units of the light's mean"},
             {"autocorrelation", Data::real, "repeat distance", "1",
              "<dI dI'> / <I>^2 of the frame without its envelope, mean over the repeat's media"},
             {"mean_autocorrelation", Data::estimate, "distance", "1", "mean over the media"},
             {"contrast", Data::real, "repeat", "1",
              "standard deviation over mean, without envelope"},
             {"mean_contrast", Data::estimate, "", "1", "root of its mean square over the media"},
             {"gaussian_contrast", Data::real, "", "1",
              "of the object's Gaussian speckle: 1/sqrt(N) for N equal points without background"},
             {"fourth_moment", Data::estimate, "", "1",
              "E|u|^4 / (E|u|^2)^2 of the points' fields; Gaussian: 2"},
             {"grains", Data::real, "repeat", "1", "independent speckle grains in the frame"},
             {"noise", Data::real, "repeat", "1", "standard deviation of the autocorrelation"},
             {"found_x", Data::real, "repeat sought", "length", "from the first, mirrored or not"},
             {"found_brightness", Data::real, "repeat sought", "1", "relative, mean 1"},
             {"found_share", Data::real, "repeat", "1", "points that were found within a grain"},
             {"brightness_match", Data::real, "repeat", "1",
              "correlation of the brightness found with the true one"},
             {"success", Data::estimate, "", "1", "media in which all points were found"},
             {"pair_distance", Data::real, "pair", "length", "of two points of the object"},
             {"pair_correlation", Data::estimate, "pair", "1",
              "C_I of their speckles, from light paths"},
             {"predicted_success", Data::real, "", "1",
              "probability that all points are found, from the pairs' signals alone"},
             {"pair_signal", Data::real, "pair", "1",
              "height of their peak in a frame's autocorrelation over its noise, predicted"}},
    .attributes = {{"frame", "magnification", "float64",
                    "pixels that the picture moves by for a length of the object"}},
    .roles = {{"PLACE", {"1", "length"}}}};

namespace {

Estimate mean_autocorrelation(const std::vector<ImagedMedium>& media) {
  const auto n = static_cast<double>(media.size());
  const std::size_t lags = media.front().statistics.autocorrelation.size();
  Estimate mean{std::vector<Complex>(lags), std::vector<double>(lags)};
  for (std::size_t lag = 0; lag < lags; ++lag) {
    double sum = 0, squares = 0;
    for (const ImagedMedium& medium : media) {
      const double value = medium.statistics.autocorrelation[lag];
      sum += value / n;
      squares += value * value / n;
    }
    mean.value[lag] = sum;
    mean.error[lag] = media.size() > 1 ? std::sqrt(std::max(squares - sum * sum, 0.0) / (n - 1))
                                       : media.front().statistics.noise;
  }
  return mean;
}

void write_axes(ResultFile& file, const ResultGroup& root, const LineScene& line,
                const ImagingTask& task, double length_of_pixel) {
  file.bind("PLACE", {line.camera.depth ? "length" : "1"});
  std::vector<double> places, distances;
  for (std::size_t p = 0; p < line.camera.pixels; ++p)
    places.push_back(line.camera.place(static_cast<double>(p)));
  for (std::size_t lag = 0; lag < task.recovery.lags; ++lag)
    distances.push_back(static_cast<double>(lag) * length_of_pixel);
  root.put("camera_place", places);
  root.put("distance", distances);
}

void write_moments(const ResultGroup& root, const LineScene& line, double background,
                   const std::vector<ImagedMedium>& media) {
  const MeanOverMedia contrast = mean_contrast(line.object, media),
                      fourth = mean_fourth_moment(media);
  root.put("mean_contrast", contrast.value, contrast.error);
  root.put("gaussian_contrast", gaussian_contrast(line.object, background));
  root.put("fourth_moment", fourth.value, fourth.error);
}

void write_fits(const ResultGroup& root, const ImagingTask& task,
                const std::vector<ImagedMedium>& media, double length_of_pixel) {
  write_points(root, media, task.recovery.points, length_of_pixel);
  root.put("found_share", column(media, [](const ImagedMedium& m) { return m.score.found; }));
  root.put("brightness_match",
           column(media, [](const ImagedMedium& m) { return m.score.correlation; }));
  const auto [rate, error] = success_rate(media);
  root.put("success", rate, error);
}

void write_prediction(const ResultGroup& root, const LineScene& line, const ImagingTask& task,
                      const ImagingPrediction& prediction) {
  const ExpectedPeaks expected = expected_peaks(line, task, prediction);
  root.number("pair", expected.signals.size());
  root.put("pair_distance", prediction.distance);
  root.put("pair_correlation", prediction.correlation);
  root.put("pair_signal", expected.signals);
  if (expected.success) root.put("predicted_success", *expected.success);
}

/// What was seen in the media.
void write_frames(ResultFile& file, const ResultGroup& root, const LineScene& line,
                  const ImagingTask& task, const std::vector<ImagedMedium>& media) {
  const double moved = magnification(line), length_of_pixel = 1 / std::abs(moved);
  write_axes(file, root, line, task, length_of_pixel);
  root.number("repeat", media.size());
  root.put("frame",
           of_each(media, line.camera.pixels, [](const ImagedMedium& m) { return m.frame; }));
  root.attribute("frame", "magnification", moved);
  root.put("mean_autocorrelation", mean_autocorrelation(media));
  write_statistics(root, media);
  write_moments(root, line, task.recovery.noise.background, media);
  if (task.recovery.points > 0) write_fits(root, task, media, length_of_pixel);
}

}  // namespace

void write_imaging(ResultFile& file, const LineScene& line, const ImagingTask& task,
                   const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction) {
  const ResultGroup root(file, imaging_table);
  root.number("point", line.object.x.size());
  root.put("object_x", line.object.x);
  root.put("object_brightness", line.object.brightness);
  if (!media.empty()) write_frames(file, root, line, task, media);
  if (!prediction.distance.empty()) write_prediction(root, line, task, prediction);
  if (task.blinking.draw && !media.empty()) write_blinking(file, line, task, media);
  if (line.reference) write_pictures(file, line, task, media, prediction);
}

}  // namespace flatspeckle::mc
