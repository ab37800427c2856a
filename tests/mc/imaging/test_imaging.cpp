// Imaging of points through a medium: frames, their autocorrelation, the recovered points.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <span>

#include <doctest/doctest.h>

#include "mc/imaging/imaging.h"
#include "mc/imaging/media_statistics.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_imaging {

namespace {

using flatspeckle::tests::is_night;
using Positions = std::vector<int>;

bool distances_distinct(const Positions& x, int apart) {
  std::vector<int> distances;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) distances.push_back(std::abs(x[i] - x[j]));
  std::sort(distances.begin(), distances.end());
  if (distances.front() < apart) return false;
  for (std::size_t i = 1; i < distances.size(); ++i)
    if (distances[i] - distances[i - 1] < apart) return false;
  return true;
}

/// Draws positions with distinct distances.
Positions random_ruler(std::size_t points, int longest, int apart, std::mt19937& random) {
  std::uniform_int_distribution<int> place(0, longest);
  for (;;) {
    Positions x(points);
    for (int& each : x) each = place(random);
    if (distances_distinct(x, apart)) return x;
  }
}

/// Draws independent, exponentially distributed pixels. The patterns of the points are shifted
/// copies of one pattern; `correlation` is C_I of two of them.
std::vector<double> shifted_speckle(const Positions& x, std::size_t pixels, double correlation,
                                    std::mt19937& random) {
  std::normal_distribution<double> normal(0, std::sqrt(0.5));
  const auto field = [&](std::size_t count) {
    std::vector<Complex> u(count);
    for (Complex& each : u) each = {normal(random), normal(random)};
    return u;
  };
  const int longest = *std::max_element(x.begin(), x.end());
  const auto shared = field(pixels + static_cast<std::size_t>(longest));
  const double common = std::sqrt(std::sqrt(correlation)), own = std::sqrt(1 - common * common);
  std::vector<double> frame(pixels);
  for (const int shift : x) {
    const auto alone = field(own > 0 ? pixels : 0);
    for (std::size_t p = 0; p < pixels; ++p)
      frame[p] += std::norm(common * shared[p + static_cast<std::size_t>(shift)] +
                            (own > 0 ? own * alone[p] : 0)) /
                  static_cast<double>(x.size());
  }
  return frame;
}

LineObject object_of(const Positions& x) {
  return {{x.begin(), x.end()}, std::vector<double>(x.size(), 1)};
}

/// Returns triangular peaks of height b_i b_j and half width 1.
PairPeaks ideal_peaks(const LineObject& object, std::size_t lags) {
  PairPeaks peaks{.step = 1, .height = std::vector<double>(lags)};
  for (std::size_t i = 0; i < object.x.size(); ++i)
    for (std::size_t j = 0; j < object.x.size(); ++j) {
      const double brightness = object.brightness[i] * object.brightness[j],
                   distance = object.x[i] - object.x[j];
      if (i == j) peaks.alone += brightness;
      for (std::size_t lag = 0; i != j && lag < lags; ++lag)
        if (const double off = std::abs(static_cast<double>(lag) - distance); off < 2)
          peaks.height[lag] += brightness * (1 - off / 2);
    }
  return peaks;
}

Scene forward_box(double width, double depth, double optical_depth) {
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = 0.9;
  spec.width = width;
  spec.depth = depth;
  spec.optical_depth = optical_depth;
  return make_scene(spec);
}

}  // namespace

TEST_CASE("sparse search: noise-free autocorrelation gives the points") {
  std::mt19937 random(1);
  for (const std::size_t points : {2, 3, 4, 6, 8, 10}) {
    CAPTURE(points);
    LineObject object = object_of(random_ruler(points, 400, 3, random));
    for (const bool equal : {true, false}) {
      if (!equal)
        for (double& b : object.brightness)
          b = std::uniform_real_distribution<double>(1, 3)(random);
      const SparseFit fit = sparse_search(ideal_peaks(object, 420), {points, 2, 300});
      const ImageScore match = score(object, fit.object, 1);
      CHECK(match.found == 1);
      CHECK(fit.explained > 0.99);
      if (points > 2) CHECK(match.correlation > 0.99);
    }
  }
}

TEST_CASE("grain size: the fitted peak at lag 0 is unaffected by a wide base and noise") {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0, 0.003);
  for (const double band : {1.0, 0.6, 0.3, 0.1}) {
    std::vector<double> values(1000);
    for (std::size_t lag = 0; lag < values.size(); ++lag)
      values[lag] = 0.2 * speckle_peak(static_cast<double>(lag), band) +
                    0.02 * std::exp(-static_cast<double>(lag) / 300) + noise(random);
    CHECK(grain_of(fitted_band(values, 0.003)) == doctest::Approx(grain_of(band)).epsilon(0.1));
  }
}

TEST_CASE("sparse search: an impossible task returns no points") {
  CHECK(sparse_search({1, std::vector<double>(8, 1.0), 1, 1}, {6, 1}).object.x.empty());
  const LineObject none;
  CHECK(score(object_of({0, 4, 9}), none, 1).found == 0);
}

TEST_CASE("image score: invariant under shift and mirroring") {
  const LineObject truth{{0, 10, 25}, {1, 2, 3}}, image{{-7, -17, -32}, {1, 2, 3}};
  const LineObject mirrored{{57, 72, 82}, {3, 2, 1}}, other{{0, 10, 30}, {1, 2, 3}};
  for (const LineObject& same : {image, mirrored}) {
    CHECK(score(truth, same, 0.1).found == 1);
    CHECK(score(truth, same, 0.1).correlation == doctest::Approx(1));
  }
  CHECK(score(truth, other, 0.1).found == doctest::Approx(2.0 / 3));
}

TEST_CASE("pair peaks: ratio of peak to noise agrees with the prediction") {
  std::mt19937 random(2);
  struct Case {
    std::size_t grains;
    int points;
    double correlation;
  };
  std::vector<Case> cases{{100000, 32, 1}, {100000, 4, 0.6}, {100000, 2, 0.3}};
  for (const std::size_t grains : {1000, 10000})
    for (const int points : {2, 8, 32})
      for (const double correlation : {1.0, 0.6, 0.3})
        cases.push_back({grains, points, correlation});
  if (!is_night)  // each number of points and each correlation
    cases = {{100000, 4, 0.6}, {1000, 2, 0.6}, {1000, 8, 0.3}, {1000, 32, 1}, {10000, 2, 1}};
  for (const Case& of : cases) {
    const std::size_t grains = of.grains;
    const int points = of.points;
    const double correlation = of.correlation;
    CAPTURE(grains);
    CAPTURE(points);
    const std::size_t lags = grains > 5000 ? 128 : 32;
    Positions x{0, 5};  // the other points are so far apart that their peaks lie beyond the lags
    for (int i = 2; i < points; ++i) x.push_back(static_cast<int>(4 * lags) * i + 5 * i * i);
    const int runs = (grains > 50000 ? 20 : grains > 5000 ? 60 : 300) / (is_night ? 1 : 2);
    double peak = 0, noise = 0;
    for (int run = 0; run < runs; ++run) {
      const auto found = frame_statistics(shifted_speckle(x, grains, correlation, random), lags);
      const auto beyond = std::span(found.autocorrelation).subspan(10);
      const double base =
          std::reduce(beyond.begin(), beyond.end()) / static_cast<double>(beyond.size());
      peak += (found.autocorrelation[5] - base) / runs;  // lowered a little with the envelope
      noise += found.noise * found.noise / runs;
    }
    const std::vector<double> all(static_cast<std::size_t>(points * (points - 1) / 2), correlation);
    const double expected = peaks_over_noise(object_of(x), all, {static_cast<double>(grains)})[0];
    CHECK(std::abs(peak / std::sqrt(noise) - expected) < 0.1 * expected + 4 / std::sqrt(runs));
  }
}

TEST_CASE("pair peaks with camera noise: ratio of peak to noise agrees with the prediction") {
  std::mt19937 random(5);
  constexpr std::size_t pixels = 10000, lags = 128;
  const Positions x{0, 5, 600, 1325};
  const std::vector<double> all(6, 0.8);
  for (const CameraNoise& noise : {CameraNoise{.photons = 3}, CameraNoise{.photons = 0.3},
                                   CameraNoise{.photons = 2, .read_noise = 3, .background = 0.5}}) {
    CAPTURE(noise.photons);
    const int runs = is_night ? 100 : 40;
    double peak = 0, square = 0;
    for (int run = 0; run < runs; ++run) {
      auto frame = shifted_speckle(x, pixels, 0.8, random);
      RandomStream stream(1, static_cast<std::uint64_t>(Stream::camera),
                          static_cast<std::uint64_t>(run));
      expose(frame, noise, stream);
      const auto found = frame_statistics(frame, lags, noise);
      peak += found.autocorrelation[5] / runs;
      square += found.noise * found.noise / runs;
    }
    const double expected = peaks_over_noise(object_of(x), all, {pixels, noise, pixels})[0],
                 fluctuation = 4 / std::sqrt(runs);  // noise of the mean peak
    CHECK(std::abs(peak / std::sqrt(square) - expected) < 0.1 * expected + fluctuation);
  }
}

TEST_CASE("sparse search: one speckle frame gives the points") {
  std::mt19937 random(3);
  int found = 0;
  constexpr int objects = 20;
  for (int i = 0; i < objects; ++i) {
    const Positions x = random_ruler(static_cast<std::size_t>(4 + i % 5), 200, 2, random);
    const auto frame = shifted_speckle(x, 10000, 1, random);
    const auto statistics = frame_statistics(frame, 220);
    CHECK(statistics.variance.off < 1e-12);
    CHECK(statistics.grain == doctest::Approx(1).epsilon(0.1));
    const auto fit = sparse_search(statistics.peaks, {x.size(), 1, 300});
    found += score(object_of(x), fit.object, 0.5).found == 1;
  }
  CHECK(found >= 18);
}

TEST_CASE("camera noise: variance agrees with the model, corrected contrast is unchanged") {
  std::mt19937 random(4);
  const auto clean = shifted_speckle({0}, 200000, 1, random);
  const CameraNoise noise{.photons = 5, .read_noise = 2, .background = 0.5};
  std::vector<double> frame = clean;
  RandomStream stream(1, static_cast<std::uint64_t>(Stream::camera), 0);
  expose(frame, noise, stream);
  double mean = 0, square = 0;
  for (std::size_t p = 0; p < frame.size(); ++p) {
    const double off = frame[p] - clean[p] - noise.background;
    mean += off / static_cast<double>(frame.size());
    square += off * off / static_cast<double>(frame.size());
  }
  const double expected = noise_variance(noise) * 1.5 * 1.5;
  CHECK(std::abs(mean) < 4 * std::sqrt(expected / static_cast<double>(frame.size())));
  CHECK(square == doctest::Approx(expected).epsilon(0.02));
  CHECK(frame_statistics(frame, 64, noise).contrast == doctest::Approx(1 / 1.5).epsilon(0.02));
}

TEST_CASE("contrast corrected for camera noise: independent of the number of photons") {
  std::mt19937 random(7);
  constexpr std::size_t pixels = 2048;
  const int runs = is_night ? 300 : 100;
  for (const double photons : {8.0, 2.0, 0.5, 0.2}) {
    CAPTURE(photons);
    const CameraNoise noise{.photons = photons, .read_noise = photons / 4};
    double sum = 0, squares = 0;
    for (int run = 0; run < runs; ++run) {
      auto frame = shifted_speckle({0, 5, 13, 31}, pixels, 1, random);
      for (std::size_t p = 0; p < pixels;
           ++p)  // brighter in the middle, where the contrast is measured
        frame[p] *=
            1 + 0.4 * std::cos(2 * std::numbers::pi * (static_cast<double>(p) / pixels - 0.5));
      RandomStream stream(2, static_cast<std::uint64_t>(Stream::camera),
                          static_cast<std::uint64_t>(run));
      expose(frame, noise, stream);
      const double square = frame_statistics(frame, 64, noise).square;
      sum += square / runs;
      squares += square * square / runs;
    }
    CHECK(std::abs(sum - 0.25) < 4 * std::sqrt((squares - sum * sum) / runs));
  }
}

TEST_CASE("autocorrelation: uneven illumination leaves no pedestal at large lags") {
  std::mt19937 random(8);
  constexpr std::size_t pixels = 8192, lags = 900;
  constexpr int runs = 20;
  double pedestal = 0, alone = 0, noise = 0;
  for (int run = 0; run < runs; ++run) {
    auto frame = shifted_speckle({0, 5, 13, 31}, pixels, 1, random);
    for (std::size_t p = 0; p < pixels; ++p)
      frame[p] *= std::exp(-std::pow((static_cast<double>(p) / pixels - 0.5) / 0.35, 2));
    const auto found = frame_statistics(frame, lags);
    for (std::size_t lag = 40; lag < lags; ++lag)
      pedestal += found.autocorrelation[lag] / (runs * static_cast<double>(lags - 40));
    alone += found.autocorrelation[0] / runs;
    noise += found.noise / runs;
  }
  CHECK(std::abs(pedestal) < 0.3 * noise);
  CHECK(alone == doctest::Approx(0.25).epsilon(0.03));
}

TEST_CASE("moved point: shift and correlation of its speckle agree with the prediction") {
  struct Case {
    bool near;
    double x;
  };
  for (const Case& place : {Case{false, 0}, Case{true, 0}, Case{false, 1500}}) {
    CAPTURE(place.x);
    const auto& [near, x] = place;
    const LineObject object{{x, x + 30}, {1, 1}};
    LineCamera camera{std::nullopt, -0.3, 0.3, 700};
    if (near) camera = {3020.0, -900, 900, 700};
    const LineScene line = line_scene(forward_box(300, 20, 5), object, -3000, camera);
    const double shift = shift_of(line, x + 30) - shift_of(line, x);
    if (x == 0) CHECK(shift == doctest::Approx(magnification(line) * 30).epsilon(1e-3));
    const auto expected = predicted(line, 20000, 1, 2);
    const FieldDraw draw =
        fields_by_paths(line.scene, make_plan(line.scene, ReversedPaths::automatic), 1, 1000);
    // correlation of the two intensities by shift, over frames
    const int longest = static_cast<int>(2 * std::abs(shift));
    std::vector<double> correlations(2 * static_cast<std::size_t>(longest) + 1);
    const int frames = is_night ? 40 : 20;
    for (int frame = 0; frame < frames; ++frame) {
      std::vector<Complex> field(1400);
      std::vector<double> intensity(1400);
      draw(static_cast<std::uint64_t>(frame), field, intensity);
      const auto of = [&](std::size_t point) {
        std::vector<double> one(700);
        for (std::size_t p = 0; p < 700; ++p) one[p] = std::norm(field[point * 700 + p]);
        return without_envelope(one, 100);
      };
      const auto first = of(0), second = of(1);
      for (int s = -longest; s <= longest; ++s)
        for (int p = 100; p < 600; ++p)
          correlations[static_cast<std::size_t>(s + longest)] +=
              first[static_cast<std::size_t>(p)] * second[static_cast<std::size_t>(p + s)] /
              (500.0 * frames);
    }
    const auto peak = std::max_element(correlations.begin(), correlations.end());
    CHECK(std::abs(static_cast<double>(peak - correlations.begin()) - longest - shift) < 1.5);
    CHECK(*peak == doctest::Approx(expected.correlation.value[0].real()).epsilon(0.2));
  }
}

}  // namespace flatspeckle::mc::test_imaging
