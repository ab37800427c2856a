// Deconvolution of frames by the frame of a reference point.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "mc/imaging/recovery/deconvolution.h"

namespace flatspeckle::mc::test_deconvolution {

namespace {

using Method = DeconvolutionTask::Method;

/// Draws independent, exponentially distributed pixels.
std::vector<double> speckle(std::size_t pixels, std::mt19937& random) {
  std::exponential_distribution<double> law(1);
  std::vector<double> values(pixels);
  for (double& value : values) value = law(random);
  return values;
}

constexpr std::size_t pixels = 4000, lags = 64;

struct Frames {
  std::vector<double> frame, reference;
};

/// Draws frames of shifted points; `correlation` is C_I of each point with the reference.
Frames frames_of(const LineObject& shifts, double correlation, std::mt19937& random) {
  const auto shared = speckle(pixels + 2 * lags, random);
  Frames frames{std::vector<double>(pixels),
                {shared.begin() + lags, shared.begin() + lags + pixels}};
  for (std::size_t i = 0; i < shifts.x.size(); ++i) {
    const auto own = speckle(pixels, random);
    const auto first = static_cast<long>(lags) - static_cast<long>(shifts.x[i]);
    for (std::size_t p = 0; p < pixels; ++p)
      frames.frame[p] +=
          shifts.brightness[i] *
          (correlation * shared[static_cast<std::size_t>(static_cast<long>(p) + first)] +
           std::sqrt(1 - correlation * correlation) * own[p]);
  }
  return frames;
}

double psnr_of(const LineObject& truth, const Frames& frames, const DeconvolutionTask& task) {
  const auto found = deconvolved(frames.frame, frames.reference, lags, task);
  return psnr(point_picture(truth, lags, found.grain), found.picture);
}

const LineObject object{{-31, 4, 19}, {1, 3, 2}};

}  // namespace

TEST_CASE(
    "deconvolution: positions and brightness of points are recovered, not their mirror image") {
  std::mt19937 random(1);
  const Frames frames = frames_of(object, 1, random);
  CHECK(psnr_of(object, frames, {}) > 30);
  CHECK(psnr_of(object, frames, {Method::richardson_lucy}) > 35);
  const LineObject mirrored{{31, -4, -19}, {1, 3, 2}};
  CHECK(psnr_of(mirrored, frames, {}) < 22);
  CHECK(psnr_of(mirrored, frames, {Method::richardson_lucy}) < 22);
}

TEST_CASE("deconvolution: PSNR falls with the correlation to the reference") {
  std::mt19937 random(2);
  for (const Method method : {Method::wiener, Method::richardson_lucy}) {
    double before = 100;
    for (const double correlation : {1.0, 0.7, 0.3, 0.1}) {
      const double now = psnr_of(object, frames_of(object, correlation, random), {method});
      CHECK(now < before - 1);
      before = now;
    }
  }
}

TEST_CASE("Richardson-Lucy: the residual falls to the uncorrelated part") {
  std::mt19937 random(3);
  const Frames frames = frames_of({{10}, {1}}, 0.8, random);
  const auto found =
      deconvolved(frames.frame, frames.reference, lags, {Method::richardson_lucy, 0.3, 60});
  REQUIRE(found.residual.size() == 60);
  CHECK(std::is_sorted(found.residual.rbegin(), found.residual.rend()));
  CHECK(found.residual.back() == doctest::Approx(0.6 / 1.4).epsilon(0.1));
}

TEST_CASE("PSNR: agrees with its definition") {
  std::vector<double> truth(101), picture(101);
  truth[50] = 2;
  picture[50] = 6;
  picture[51] = picture[49] = 3;
  // the best scale is (6 * 2) / (36 + 9 + 9)
  const double left = 4 - 144.0 / 54;
  CHECK(psnr(truth, picture) == doctest::Approx(10 * std::log10(4 * 101 / left)));
  CHECK(psnr(truth, truth) > 100);
}

}  // namespace flatspeckle::mc::test_deconvolution
