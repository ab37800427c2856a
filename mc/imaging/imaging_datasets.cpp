#include "mc/imaging/imaging_datasets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "core/algebra/dense.h"
#include "core/result/result_group.h"
#include "mc/imaging/line_camera.h"
#include "mc/imaging/media_statistics.h"
#include "mc/theory/detector_noise.h"
#include "mc/imaging/recovery/deconvolution.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/recovery/line_spectrum.h"
#include "mc/imaging/recovery/recovery_datasets.h"
#include "mc/imaging/separation/separation.h"

namespace flatspeckle::mc {

const DatasetTable blinking_table{
    .name = "blinking",
    .rows = {
        {"blinking_frame", Data::numbers, "", "1", "number of the frame of a medium"},
        {"source", Data::numbers, "", "1", "number of the source"},
        {"frames", Data::real, "blinking_frame camera_place", "1",
         "all frames of the first medium, in units of the mean of the light over these frames"},
        {"point_brightness", Data::real, "blinking_frame point", "1",
         "brightness of each point in the frames of the first medium, relative to "
         "object_brightness"},
        {"pair_excitation", Data::real, "pair", "1",
         "C_I of the light that excites two points (speckle)"},
        {"frame_contrast", Data::estimate, "", "1",
         "contrast of single frames before camera noise: root of the mean square"},
        {"expected_frame_contrast", Data::real, "", "1",
         "contrast expected for Gaussian speckle with the drawn brightness"},
        {"singular_value", Data::real, "repeat blinking_frame", "1",
         "singular values of the frames divided by their mean, largest first; the camera's noise "
         "is whitened if it is known"},
        {"noise_level", Data::real, "repeat", "1",
         "threshold: singular values above it count as sources"},
        {"source_count", Data::count, "repeat", "1", "number of singular values above noise_level"},
        {"factor_residual", Data::real, "repeat", "1",
         "rms residual of the factorisation, divided by the rms of the light"},
        {"source_pattern", Data::real, "source camera_place", "1",
         "speckle pattern of each source in the first medium, mean 1"},
        {"source_x", Data::real, "repeat source", "length",
         "positions of the sources of the largest group, relative to the first; not mirrored"},
        {"source_brightness", Data::real, "repeat source", "1",
         "relative brightness, mean over the frames; 0 for sources outside the largest group"},
        {"pattern_match", Data::real, "repeat point", "1",
         "correlation of each point's speckle with the most similar pattern"},
        {"sources_share", Data::real, "repeat", "1",
         "fraction of the points that have a source within a grain, without mirroring"},
        {"sources_success", Data::estimate, "", "1",
         "fraction of the media in which all points have such a source"}}};

FrameContrast frame_contrast(const std::vector<ImagedMedium>& media) {
  const auto mean = [&](double Blinked::*square) {
    return root_of(mean_over(media, 0, [=](const ImagedMedium& m) { return m.blinked.*square; }));
  };
  return {mean(&Blinked::square), mean(&Blinked::expected_square).value};
}

MeanOverMedia sources_success(const std::vector<ImagedMedium>& media) {
  return share_of(media, [](const ImagedMedium& m) { return m.blinked.score.found == 1; });
}

namespace {

void write_first(const ResultGroup& root, const Blinked& first, std::size_t points) {
  std::vector<double> values;
  for (const auto& frame : first.frames) values.insert(values.end(), frame.begin(), frame.end());
  root.put("frames", values);
  root.put("point_brightness", std::span(first.brightness).first(first.frames.size() * points));
}

/// Writes positions and brightness of the sources of the largest group in each medium, padded with
/// zeros.
void write_places(const ResultGroup& root, const std::vector<ImagedMedium>& media,
                  std::size_t sources, double length_of_pixel) {
  const auto of_object = [&](double scale, std::vector<double> LineObject::*member) {
    return of_each(media, sources, [=](const ImagedMedium& m) {
      auto values = m.blinked.found.object().*member;
      for (double& value : values) value *= scale;
      return values;
    });
  };
  root.put("source_x", of_object(length_of_pixel, &LineObject::x));
  root.put("source_brightness", of_object(1, &LineObject::brightness));
}

void write_sources(const ResultGroup& root, const LineScene& line,
                   const std::vector<ImagedMedium>& media) {
  std::size_t most = 0;
  for (const ImagedMedium& m : media) most = std::max(most, m.blinked.found.places.x.size());
  const auto of_medium = [&](auto value) {
    return column(media, [value](const ImagedMedium& m) { return value(m.blinked); });
  };
  root.put("singular_value",
           of_each(media, media.front().blinked.found.count.singular_values.size(),
                   [](const ImagedMedium& m) { return m.blinked.found.count.singular_values; }));
  root.put("noise_level", of_medium([](const Blinked& b) { return b.found.count.threshold; }));
  root.put("source_count", of_medium([](const Blinked& b) { return b.found.count.sources; }));
  root.put("factor_residual", of_medium([](const Blinked& b) { return b.found.factors.residual; }));
  root.put("sources_share", of_medium([](const Blinked& b) { return b.score.found; }));
  root.put("pattern_match", of_each(media, line.object.x.size(),
                                    [](const ImagedMedium& m) { return m.blinked.pattern_match; }));
  const MeanOverMedia rate = sources_success(media);
  root.put("sources_success", rate.value, rate.error);
  if (most == 0) return;
  root.number("source", most);
  write_places(root, media, most, 1 / magnification(line));
  auto pattern = row_major(media.front().blinked.found.factors.pattern.transpose());
  pattern.resize(most * line.camera.pixels);
  root.put("source_pattern", pattern);
}

/// Means over an exponentially distributed power x of mean 1: response is the mean of x / (x + e),
/// square the mean of its square, noise the mean of x / (x + e)^2.
struct FilterMeans {
  double response = 0, square = 0, noise = 0;

  explicit FilterMeans(double e) {
    constexpr int steps = 200;
    for (int i = 0; i < steps; ++i) {
      const double x = -std::log((i + 0.5) / steps), passed = x / (x + e);
      response += passed / steps;
      square += passed * passed / steps;
      noise += passed / (x + e) / steps;
    }
  }
};

/// Predicted picture, and its noise.
struct Expected {
  std::vector<double> picture;
  double noise = 0;  ///< variance of each value of the picture
};

/// Composition of a frame, for expected_psnr().
struct Shares {
  LineObject at;                    ///< points, with their shifts in pixels
  std::vector<double> coefficient;  ///< for each point: its fraction of the light times C_I
  /// Power spectrum of the speckle of the reference, and also of each point.
  std::vector<double> speckle;
  /// Power of the speckle that is uncorrelated with that of the reference, in units of `speckle`.
  double other = 0;
  double white = 0;  ///< power of the camera's noise
};

Complex spectrum_of(const Shares& of, double frequency) {
  Complex sum = 0;
  for (std::size_t i = 0; i < of.at.x.size(); ++i)
    sum += std::polar(of.coefficient[i], -2 * std::numbers::pi * frequency * of.at.x[i]);
  return sum;
}

Expected expected(const Shares& of, const LineSpectrum& spectra, double regularisation,
                  double width) {
  std::vector<double> power = of.speckle;
  for (double& value : power) value += of.white;
  const double level = regularisation * typical_power(power);
  const std::size_t n = spectra.size();
  std::vector<Complex> spectrum(n);
  Expected result;
  for (std::size_t m = 0; m <= n / 2; ++m) {
    if (power[m] == 0) continue;
    const double frequency = spectra.frequency(m), blur = gaussian_spectrum(frequency, width);
    const FilterMeans filter(level / power[m]);
    const Complex object = blur * of.speckle[m] / power[m] * spectrum_of(of, frequency);
    spectrum[m] = filter.response * object;
    if (m > 0) spectrum[n - m] = std::conj(spectrum[m]);
    const double scatter = filter.square - filter.response * filter.response,
                 uncorrelated = (of.speckle[m] * of.other + of.white) / power[m],
                 both_signs = m == 0 || 2 * m == n ? 1 : 2;
    result.noise +=
        both_signs * (std::norm(object) * scatter + blur * blur * uncorrelated * filter.noise);
  }
  result.noise /= static_cast<double>(n) * static_cast<double>(n);
  result.picture = spectra.line(std::move(spectrum));
  return result;
}

void write_residuals(const ResultGroup& root, const std::vector<ImagedMedium>& media) {
  const std::size_t steps = media.front().deconvolved.residual.size();
  root.number("iteration", steps);
  root.put("residual",
           of_each(media, steps, [](const ImagedMedium& m) { return m.deconvolved.residual; }));
}

Estimate mean_autocorrelation(const std::vector<ImagedMedium>& media) {
  const FrameStatistics& first = media.front().statistics;
  Estimate mean;
  for (std::size_t lag = 0; lag < first.autocorrelation.size(); ++lag) {
    const auto [value, error] = mean_over(media, first.noise, [lag](const ImagedMedium& medium) {
      return medium.statistics.autocorrelation[lag];
    });
    mean.value.emplace_back(value);
    mean.error.push_back(error);
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

/// Writes frames of all media, and results from them.
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

void write_blinking(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media) {
  const ResultGroup root(file, blinking_table);
  root.number("blinking_frame", task.blinking.frames);
  write_first(root, media.front().blinked, line.object.x.size());
  const FrameContrast contrast = frame_contrast(media);
  root.put("frame_contrast", contrast.found.value, contrast.found.error);
  root.put("expected_frame_contrast", contrast.expected);
  if (!task.blinking.correlation.empty()) root.put("pair_excitation", task.blinking.correlation);
  if (task.blinking.separates) write_sources(root, line, media);
}

const DatasetTable picture_table{
    .name = "picture",
    .rows = {
        {"picture_x", Data::scale, "", "length", "place on the object's line"},
        {"reference_x", Data::real, "", "length", "x of the reference point"},
        {"reference_frame", Data::real, "repeat camera_place", "1",
         "frame of the reference point alone, in units of the light's mean"},
        {"true_picture", Data::real, "picture_x", "1",
         "the object, with a Gaussian as wide as a grain for each point"},
        {"picture", Data::real, "repeat picture_x", "1",
         "frames deconvolved by their reference; the scale is arbitrary"},
        {"psnr", Data::real, "repeat", "1",
         "peak signal-to-noise ratio in dB: largest value of true_picture over the rms difference"},
        {"mean_psnr", Data::estimate, "", "1",
         "mean of psnr over the media, if there are at least two"},
        {"predicted_psnr", Data::real, "", "1", "psnr predicted for the Wiener filter"},
        {"iteration", Data::numbers, "", "1", "number of the iteration (richardson_lucy)"},
        {"residual", Data::real, "repeat iteration", "1",
         "rms difference between the frame and the reference convolved with the object, over the "
         "mean"},
        {"reference_correlation", Data::estimate, "point", "1",
         "C_I between the speckle of each point and of the reference, from light paths"}}};

/// The speckle of a point is modelled as that of the reference, shifted and multiplied by C_I
/// (to_reference), plus an uncorrelated part of variance 1 - C_I^2. Speckle that is shifted beyond
/// the end of the reference frame also counts as uncorrelated. The power spectrum of speckle is a
/// triangle (speckle_power()). The power at one frequency is distributed exponentially; the
/// response of the filter and the noise that passes it are averaged over this distribution. Shot
/// and read noise are white.
double expected_psnr(const LineScene& line, const ImagingTask& task,
                     const ImagingPrediction& prediction) {
  const auto to_reference = real_parts(prediction.to_reference.value);
  const CameraNoise& noise = task.recovery.noise;
  const std::size_t lags = task.recovery.lags;
  const LineSpectrum spectra(line.camera.pixels);
  const auto pixels = static_cast<double>(line.camera.pixels);
  const double contrast = 1 / (1 + noise.background);
  Shares of{shifts(line), {}, {}, 0, noise_variance(noise)};
  for (std::size_t m = 0; m < spectra.size(); ++m)
    of.speckle.push_back(contrast * contrast *
                         speckle_power(spectra.frequency(m), most_grains(line) / pixels));
  const auto& b = line.object.brightness;
  const double all = std::reduce(b.begin(), b.end());
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double share = b[i] / all, seen = 1 - std::abs(of.at.x[i]) / pixels,
                 alike = to_reference[i] * seen;
    of.coefficient.push_back(share * alike);
    of.other += share * share * (1 - alike * alike);
  }
  const double grain = pixels / most_grains(line) * 2 / 3;
  auto made = expected(of, spectra, task.deconvolution.regularisation, point_width(grain));
  const auto seen = about_zero(made.picture, lags);
  return psnr(point_picture(of.at, lags, grain), seen, made.noise);
}

void write_pictures(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction) {
  const ResultGroup root(file, picture_table);
  root.put("reference_x", *line.reference);
  root.put("reference_correlation", prediction.to_reference);
  if (task.deconvolution.method == DeconvolutionTask::Method::wiener)
    root.put("predicted_psnr", expected_psnr(line, task, prediction));
  if (media.empty()) return;
  const std::size_t lags = task.recovery.lags, shown = 2 * lags - 1;
  const bool mirrored = magnification(line) < 0;
  std::vector<double> places;
  for (std::size_t p = 0; p < shown; ++p)
    places.push_back(*line.reference + (static_cast<double>(p) - static_cast<double>(lags - 1)) /
                                           std::abs(magnification(line)));
  const auto turned = [&](std::vector<double> picture) {
    if (mirrored) std::reverse(picture.begin(), picture.end());
    return picture;
  };
  root.put("picture_x", places);
  root.put("reference_frame",
           of_each(media, line.camera.pixels, [](const ImagedMedium& m) { return m.reference; }));
  root.put("true_picture",
           turned(point_picture(shifts(line), lags, media.front().deconvolved.grain)));
  root.put("picture", of_each(media, shown, [&](const ImagedMedium& m) {
             return turned(m.deconvolved.picture);
           }));
  root.put("psnr", column(media, [](const ImagedMedium& m) { return m.psnr; }));
  const MeanOverMedia mean = mean_psnr(media);
  if (media.size() > 1) root.put("mean_psnr", mean.value, mean.error);
  if (task.deconvolution.method == DeconvolutionTask::Method::richardson_lucy)
    write_residuals(root, media);
}

const DatasetTable imaging_table{
    .name = "image",
    .rows =
        {{"camera_place", Data::scale, "", "PLACE", "pixels: x, or sines of directions"},
         {"repeat", Data::numbers, "", "1",
          "number of the medium, or of the group of media that the key average defines"},
         {"point", Data::numbers, "", "1", "number of the point of the object"},
         {"sought", Data::numbers, "", "1", "number of the sought point"},
         {"pair", Data::numbers, "", "1", "number of the pair of points (0, 1), (0, 2), ..."},
         {"distance", Data::scale, "", "length", "lag on the camera, as a distance on the object"},
         {"object_x", Data::real, "point", "length", "x of the object's points"},
         {"object_brightness", Data::real, "point", "1", "relative brightness"},
         {"frame", Data::real, "repeat camera_place", "1",
          "frame of each repeat (of its first medium if it has several; with blinking, the mean of "
          "its frames), in units of the light's mean"},
         {"autocorrelation", Data::real, "repeat distance", "1",
          "<dI dI'> / <I>^2 of the frame divided by its envelope, mean over the media of a repeat"},
         {"mean_autocorrelation", Data::estimate, "distance", "1",
          "mean of autocorrelation over the repeats"},
         {"contrast", Data::real, "repeat", "1",
          "standard deviation over mean of the frame divided by its envelope"},
         {"mean_contrast", Data::estimate, "", "1",
          "root mean square of the contrast over the repeats"},
         {"gaussian_contrast", Data::real, "", "1",
          "contrast of the object's Gaussian speckle: 1/sqrt(N) for N equal points without "
          "background"},
         {"fourth_moment", Data::estimate, "", "1",
          "E|u|^4 / (E|u|^2)^2 of the points' fields; Gaussian: 2"},
         {"grains", Data::real, "repeat", "1", "number of independent speckle grains in the frame"},
         {"noise", Data::real, "repeat", "1", "standard deviation of the autocorrelation"},
         {"found_x", Data::real, "repeat sought", "length",
          "positions of the found points relative to the first, mirrored or not"},
         {"found_brightness", Data::real, "repeat sought", "1",
          "brightness of the found points, mean 1"},
         {"found_share", Data::real, "repeat", "1",
          "fraction of the points that were found within a grain"},
         {"brightness_match", Data::real, "repeat", "1",
          "correlation of the brightness found with the true one"},
         {"success", Data::estimate, "", "1",
          "fraction of the repeats in which all points were found"},
         {"pair_distance", Data::real, "pair", "length", "distance of two points of the object"},
         {"pair_correlation", Data::estimate, "pair", "1",
          "C_I of the speckles of the two points, from light paths"},
         {"predicted_success", Data::real, "", "1",
          "probability that all points are found, predicted from the signals of the pairs"},
         {"pair_signal", Data::real, "pair", "1",
          "predicted height of the pair's peak in the autocorrelation, divided by the noise"}},
    .attributes = {{"frame", "magnification", "float64",
                    "shift of the picture in pixels per length of the object"}},
    .roles = {{"PLACE", {"1", "length"}}}};

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
