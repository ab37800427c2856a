#include "bench/scenes/blinking_frames.h"
#include "bench/scenes/imaged_points.h"
#include "bench/scenes/speckle_frames.h"
#include "bench/stability/extreme_rows.h"
#include "mc/imaging/media_statistics.h"
#include "mc/imaging/retrieval/contrast_map.h"

namespace flatspeckle::bench {

namespace {

/// Compares the recovered points with the true ones.
Finding search(const std::vector<double>& marks, double signal) {
  const auto fit = mc::sparse_search(noisy_peaks(marks, signal, 1), {marks.size(), 1, 1000});
  const mc::LineObject truth{marks, std::vector<double>(marks.size(), 1)};
  return {1 - mc::score(truth, fit.object, 1).found, 0};
}

/// Returns by how much the success probability fails to rise monotonically from 0 to 1 while the
/// peaks grow by factors of 10.
double success_figure(std::size_t points, double places, bool weighted) {
  double last = 0, figure = 0;
  for (double signal = 1e-6; signal < 1e7; signal *= 10) {
    const std::vector<double> signals(points * (points - 1) / 2, signal);
    const double now = mc::predicted_success(signals, points, places, weighted);
    figure = larger({figure, last - now, now - 1, now > -1e-12 ? 0.0 : 1.0});
    last = now;
  }
  return larger(figure, 1 - last);
}
Finding success(std::size_t points, double places) {
  return worst_of({false, true}, 1e-9,
                  [=](bool weighted) { return success_figure(points, places, weighted); });
}

/// Checks that the contrast of uncorrelated speckle is 1 under an envelope that falls by `decades`
/// powers of ten. The deviation is in standard errors for this number of pixels.
Finding steep_envelope(double decades) {
  constexpr std::size_t pixels = 20000;
  std::mt19937 random(1);
  std::exponential_distribution<double> intensity;
  std::vector<double> frame;
  for (std::size_t p = 0; p < pixels; ++p)
    frame.push_back(intensity(random) * std::pow(10, -decades * static_cast<double>(p) / pixels));
  const double error = std::sqrt(8.0 / (0.75 * pixels));  // standard error of the squared contrast
  return {std::abs(mc::squared_contrast(frame) - 1) / error, 4};
}

/// Checks the separation of sources in frames multiplied by `scale`.
Finding sources(const BlinkingScene& scene, double scale) {
  BlinkingFrames made = blinking_frames(scene, 1);
  for (auto& frame : made.frames)
    for (double& value : frame) value *= scale;
  const auto found = mc::separated_sources(made.frames, {{}, 40});
  if (found.count.sources != scene.brightness.size()) return {1, 0};
  return {pattern_error(made, found.factors.pattern), 0.05};
}

/// Checks that shot noise on uniform frames is not counted as additional sources.
Finding counted_in_noise(double photons) {
  std::vector<std::vector<double>> frames(40, std::vector<double>(1000, 1.0));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    RandomStream stream(1, static_cast<std::uint64_t>(Stream::camera), f);
    mc::expose(frames[f], {.photons = photons}, stream);
  }
  const auto found = mc::separated_sources(frames, {{.photons = photons}, 40});
  return yes(found.count.sources <= 1);
}

/// Returns by how much K^2 and autocorrelation change if all values of the frames are multiplied by
/// a number.
Finding scaled_frames(double scale) {
  const Frames frames = mixed_speckle(2, 64, 1, 1);
  Frames scaled = frames;
  for (double& value : scaled.values) value *= scale;
  const auto map = mc::contrast_map(frames, {.window = 8}),
             other = mc::contrast_map(scaled, {.window = 8});
  const auto one = mc::picture_statistics(frames, 0, 2, 12, {}),
             two = mc::picture_statistics(scaled, 0, 2, 12, {});
  double figure = 0;
  for (std::size_t p = 0; p < map.square.size(); ++p)
    figure = larger({figure, std::abs(other.square[p] / map.square[p] - 1)});
  for (std::size_t p = 0; p < one.autocorrelation.size(); ++p)
    figure = larger({figure, std::abs(one.autocorrelation[p] - two.autocorrelation[p])});
  return {figure, 1e-9};
}

/// Returns the deviation of the mean of a detector's values, in standard errors of the shot noise.
Finding detected_mean(double photons) {
  constexpr std::size_t pixels = 4096;
  RandomStream random(1, static_cast<std::uint64_t>(Stream::camera), 0);
  std::vector<double> frame(pixels, 1.0);
  mc::detect(frame, {.photons = photons}, {.quantum_efficiency = 0.5}, random);
  double mean = 0;
  for (const double value : frame) mean += value / pixels;
  return {std::abs(mean - photons / 2) / std::sqrt(photons / 2 / pixels), 5};
}

}  // namespace

void mc_imaging_extremes(ExtremeRows& rows) {
  using Marks = std::vector<double>;
  rows.add("search, 2 points", "share of points not found", search, Marks{0, 317}, 9);
  rows.add_slow("search, 12 points, peaks 1e6 times the noise", "share of points not found", search,
                Marks{0, 2, 6, 24, 29, 40, 43, 55, 68, 75, 76, 85}, 1e6);
  for (const std::size_t points : {2, 64})
    for (const double places : {1e5, 1e9})
      rows.add(
          "success, " + std::to_string(points) + " points in " + short_number(places) + " places",
          "rises from 0 to 1 as peaks grow by 1e13", success, points, places);
  rows.add("frame whose light falls by 100", "contrast 1, in standard errors", steep_envelope, 2);
  for (const double scale : {1e-150, 1e150})
    rows.add("frames of 4 sources, times " + short_number(scale), "patterns, relative", sources,
             BlinkingScene{}, scale);
  rows.add("frames of sources of brightness 1 to 30", "patterns, relative", sources,
           BlinkingScene{.frames = 80, .brightness = {1, 5, 30}}, 1);
  rows.add_each("even light of ", {1e-3, 1e6}, " photons a pixel",
                "1 where noise is counted as sources", counted_in_noise);
  rows.add_each("frames of speckle, times ", {1e-100, 1e100}, "",
                "K^2 and autocorrelation keep their values", scaled_frames);
  rows.add_each("detector, ", {1e-2, 1e12}, " photons a pixel", "mean, in standard errors",
                detected_mean);
  rows.add_refused("dark frames", "not positive", [] {
    mc::separated_sources(std::vector<std::vector<double>>(3, std::vector<double>(100, 0.0)),
                          {{}, 10});
  });
}

}  // namespace flatspeckle::bench
