// Separation of blinking sources: their number, patterns and positions.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/error.h"
#include "mc/imaging/imaging.h"
#include "mc/imaging/recovery/image_score.h"
#include "mc/imaging/separation/separation.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_separation {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

using Line = std::vector<double>;

/// Draws independent, exponentially distributed pixels.
Line speckle(std::size_t pixels, std::mt19937& random) {
  std::exponential_distribution<double> intensity;
  Line line(pixels);
  for (double& value : line) value = intensity(random);
  return line;
}

/// Mixes sources, each bright in about half of the frames, and divides by the overall mean.
std::vector<Line> mixed(const std::vector<Line>& sources, std::size_t frames,
                        std::mt19937& random) {
  std::bernoulli_distribution bright(0.5);
  std::vector<Line> made;
  double sum = 0;
  for (std::size_t f = 0; f < frames; ++f) {
    Line frame(sources.front().size());
    for (const Line& source : sources)
      if (bright(random))
        for (std::size_t p = 0; p < frame.size(); ++p) frame[p] += source[p];
    for (const double value : frame) sum += value;
    made.push_back(std::move(frame));
  }
  const double mean = sum / static_cast<double>(frames * sources.front().size());
  for (Line& frame : made)
    for (double& value : frame) value /= mean;
  return made;
}

void expose_all(std::vector<Line>& frames, const CameraNoise& noise) {
  for (std::size_t f = 0; f < frames.size(); ++f) {
    RandomStream stream(1, static_cast<std::uint64_t>(Stream::camera), f);
    expose(frames[f], noise, stream);
  }
}

double correlation(const Line& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(a.data(), b.size());
  const Eigen::VectorXd u = (x.array() - x.mean()).matrix(), v = (b.array() - b.mean()).matrix();
  return u.dot(v) / (u.norm() * v.norm());
}

/// Returns the smallest, over all sources, of the best correlation with a pattern.
double worst_match(const std::vector<Line>& sources, const MatrixXd& patterns) {
  double worst = 1;
  for (const Line& source : sources) {
    double best = 0;
    for (Index s = 0; s < patterns.cols(); ++s)
      best = std::max(best, correlation(source, patterns.col(s)));
    worst = std::min(worst, best);
  }
  return worst;
}

std::vector<Line> sources_of(std::size_t count, std::size_t pixels, std::mt19937& random) {
  std::vector<Line> sources;
  for (std::size_t s = 0; s < count; ++s) sources.push_back(speckle(pixels, random));
  return sources;
}

}  // namespace

TEST_CASE("source separation: patterns of blinking sources are recovered") {
  std::mt19937 random(1);
  for (const std::size_t count : {1, 2, 5, 10, 16}) {
    if (count > 10 && !flatspeckle::tests::is_night) continue;
    CAPTURE(count);
    const auto sources = sources_of(count, 1000, random);
    const auto found = separated_sources(mixed(sources, 4 * count + 20, random), {.lags = 50});
    CHECK(found.count.sources == count);
    CHECK(worst_match(sources, found.factors.pattern) > 0.98);
    CHECK(found.factors.residual < 0.02);
    CHECK(found.factors.pattern.minCoeff() >= 0);
    CHECK(found.factors.brightness.minCoeff() >= 0);
    for (Index s = 0; s < found.factors.pattern.cols(); ++s)
      CHECK(found.factors.pattern.col(s).mean() == doctest::Approx(1));
  }
}

TEST_CASE("source separation: sources are counted correctly with camera noise") {
  std::mt19937 random(2);
  const auto sources = sources_of(6, 1000, random);
  for (const CameraNoise& noise :
       {CameraNoise{.photons = 100}, CameraNoise{.photons = 20, .read_noise = 2},
        CameraNoise{.photons = 20, .background = 1}}) {
    CAPTURE(noise.photons);
    CAPTURE(noise.background);
    auto frames = mixed(sources, 60, random);
    expose_all(frames, noise);
    const auto found = separated_sources(frames, {.noise = noise, .lags = 50});
    CHECK(found.count.sources == 6);
    CHECK(worst_match(sources, found.factors.pattern) > 0.9);
  }
}

TEST_CASE("source count: one pattern of varying brightness is one source at any photon number") {
  for (const double photons : {0.2, 1.0, 50.0}) {
    CAPTURE(photons);
    int right = 0;
    constexpr int runs = 20;
    for (int run = 0; run < runs; ++run) {
      std::vector<Line> frames;
      for (int f = 0; f < 40; ++f) {  // uneven over pixels and frames
        Line frame(500);
        for (std::size_t p = 0; p < frame.size(); ++p)
          frame[p] = (1 + 0.8 * std::sin(static_cast<double>(p) / 30)) * (f % 2 ? 1.5 : 0.5);
        RandomStream stream(3, static_cast<std::uint64_t>(Stream::camera),
                            static_cast<std::uint64_t>(100 * run + f));
        expose(frame, {.photons = photons}, stream);
        frames.push_back(std::move(frame));
      }
      MatrixXd light(500, 40);
      for (Index f = 0; f < 40; ++f)
        for (Index p = 0; p < 500; ++p)
          light(p, f) = frames[static_cast<std::size_t>(f)][static_cast<std::size_t>(p)];
      right += source_count(light, {.photons = photons}).sources == 1;
    }
    CHECK(right >= 18);
  }
}

TEST_CASE("source positions: chained shifts extend beyond the memory-effect range") {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, std::sqrt(0.5));
  const std::vector<double> x{0, 37, 80, 110, 163, 201};
  constexpr std::size_t pixels = 3000;
  // the field of a point changes gradually for x from 0 to 250
  std::vector<std::pair<Line, Line>> fields;
  for (int part = 0; part < 6; ++part) {
    Line re(pixels + 300), im(pixels + 300);
    for (double& value : re) value = normal(random);
    for (double& value : im) value = normal(random);
    fields.emplace_back(re, im);
  }
  MatrixXd patterns(pixels, 6);
  for (std::size_t s = 0; s < 6; ++s) {
    const double place = x[s] / 50, part = std::floor(place), by = place - part;
    const auto& [re, im] = fields[static_cast<std::size_t>(part)];
    const auto& [next_re, next_im] = fields[static_cast<std::size_t>(part) + 1];
    for (std::size_t p = 0; p < pixels; ++p) {
      const std::size_t q = p + 250 - static_cast<std::size_t>(x[s]);
      const double a = std::sqrt(1 - by) * re[q] + std::sqrt(by) * next_re[q],
                   b = std::sqrt(1 - by) * im[q] + std::sqrt(by) * next_im[q];
      patterns(static_cast<Index>(p), static_cast<Index>(s)) = a * a + b * b;
    }
  }
  const auto shifts = pattern_shifts(patterns, 250);
  CHECK(shifts.size() < 15);  // distant pairs have none
  const auto places = source_places(6, shifts, 1);
  for (std::size_t s = 0; s < 6; ++s) {
    CHECK(places.group[s] == 0);
    CHECK(places.x[s] == doctest::Approx(x[s]).epsilon(0.002));
  }
}

TEST_CASE("source positions: uncorrelated sources stay apart, one outlier shift is ignored") {
  std::mt19937 random(4);
  MatrixXd patterns(2000, 3);
  for (Index s = 0; s < 3; ++s) {
    const Line line = speckle(2000, random);
    patterns.col(s) = Eigen::Map<const Eigen::VectorXd>(line.data(), 2000);
  }
  patterns.col(2).tail(1990) = patterns.col(0).head(1990);
  const auto shifts = pattern_shifts(patterns, 100);
  REQUIRE(shifts.size() == 1);
  CHECK(shifts[0].shift == doctest::Approx(10).epsilon(0.01));
  const auto apart = source_places(3, shifts, 1);
  CHECK(apart.group == std::vector<std::size_t>{0, 1, 0});
  const auto placed =
      source_places(3, {{0, 1, 10, 0.9, 0.01}, {1, 2, 7, 0.8, 0.01}, {0, 2, -50, 0.3, 0.01}}, 1);
  CHECK(placed.x[1] == doctest::Approx(10));
  CHECK(placed.x[2] == doctest::Approx(17));
}

TEST_CASE("source separation: dark and too few frames are rejected") {
  CHECK_THROWS_AS(separated_sources(std::vector<Line>(3, Line(100, 0.0)), {.lags = 10}),
                  InputError);
  std::mt19937 random(5);
  const auto frames = mixed(sources_of(2, 100, random), 3, random);
  CHECK_THROWS_AS(separated_sources(frames, {.lags = 10, .sources = 4}), InputError);
}

}  // namespace flatspeckle::mc::test_separation
