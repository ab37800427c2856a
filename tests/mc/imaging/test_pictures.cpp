// Frames of objects in space: detector, places, structural similarity, prediction.
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <doctest/doctest.h>

#include "mc/imaging/camera_exposure.h"
#include "mc/imaging/retrieval/picture_points.h"
#include "mc/imaging/simulated/picture_frames.h"
#include "mc/imaging/simulated/picture_prediction.h"
#include "mc/imaging/simulated/picture_scene.h"
#include "mc/imaging/simulated/picture_score.h"
#include "mc/paths/speckle/speckle_field.h"
#include "mc/slab/adding/space.h"

namespace flatspeckle::mc::test_pictures {

namespace {

Scene fog(double optical_depth = 8, std::optional<double> medium_index = {}) {
  SceneSpec spec;
  spec.medium_index = medium_index;
  spec.dimension = 3;
  spec.width = spec.height = 100;
  spec.depth = 4;
  spec.scatterer = "hg";
  spec.g = 0.9;
  spec.optical_depth = optical_depth;
  return in_space(make_scene(spec), spec);
}

/// Two points along x and one off the axis.
PictureScene points_behind_fog(bool far) {
  const double z = far ? 0 : -2000, scale = far ? 1.0 / 2000 : 1;
  PictureObject object{
      {{-20 * scale, z, 0}, {20 * scale, z, 0}, {0, z, 12 * scale}}, {1, 2, 1}, far};
  return picture_scene(fog(), std::move(object), {{0, 1, 0}, 0.1, 64});
}

struct FrameMoments {
  double mean = 0, variance = 0;
};

FrameMoments moments_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  FrameMoments found;
  found.mean = std::reduce(values.begin(), values.end()) / n;
  for (const double value : values) found.variance += std::pow(value - found.mean, 2) / n;
  return found;
}

}  // namespace

TEST_CASE("detector: mean and variance of electrons and of rounded values, saturated pixels") {
  constexpr std::size_t pixels = 40000;
  RandomStream random(1, 0, 0);
  const CameraNoise noise{.photons = 200, .read_noise = 5, .background = 0.25};
  std::vector<double> electrons(pixels, 1.0);
  CHECK(detect(electrons, noise, {.quantum_efficiency = 0.6}, random) == 0);
  const auto [mean, variance] = moments_of(electrons);
  CHECK(mean == doctest::Approx(150).epsilon(4 * 0.09 / 150));
  CHECK(variance == doctest::Approx(175).epsilon(4 * std::sqrt(2.0 / pixels)));

  const Detector coarse{.quantum_efficiency = 0.6, .full_well = 255 * 8, .bit_depth = 8};
  std::vector<double> values(pixels, 1.0);
  detect(values, noise, coarse, random);
  const auto rounded = moments_of(values);
  CHECK(coarse.step() == 8);
  CHECK(values.front() == std::round(values.front()));
  const CameraNoise all = detected_noise(noise, coarse);
  CHECK(rounded.variance / (rounded.mean * rounded.mean) ==
        doctest::Approx(noise_variance(all)).epsilon(4 * std::sqrt(2.0 / pixels)));

  std::vector<double> bright{1, 1, 3, 3};
  CHECK(detect(bright, {.photons = 1000}, {.full_well = 2000, .bit_depth = 4}, random) == 2);
  CHECK(bright[2] == 15);
}

TEST_CASE("pictures: the speckle of a point moves against its place in the picture") {
  for (const bool far : {false, true}) {
    const PictureScene scene = points_behind_fog(far);
    const PixelPlace left = place_in_picture(scene, scene.object.place[0]),
                     right = place_in_picture(scene, scene.object.place[1]);
    const auto moved = std::lround(right.x - left.x);
    CHECK(right.x - left.x == doctest::Approx(0.02 * 320).epsilon(1e-3));
    PictureTask task;
    constexpr std::size_t side = 64, channels = 3 * side * side;
    std::vector<Complex> field(channels);
    picture_fields(scene, task, 4000)(0, field, {});
    // Correlation of the fields of both points at the predicted shift and at the opposite one
    const auto correlation = [&](long shift) {
      Complex sum = 0;
      double a = 0, b = 0;
      for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 10; x + 10 < side; ++x) {
          const Complex one = field[y * side + x],
                        other = field[side * side + y * side + x - static_cast<std::size_t>(shift)];
          sum += one * std::conj(other), a += std::norm(one), b += std::norm(other);
        }
      return std::norm(sum) / (a * b);
    };
    CHECK(correlation(moved) > 0.3);
    CHECK(correlation(-moved) < 0.15);
  }
}

TEST_CASE("pictures: fields behind faces agree with a sum path by path") {
  constexpr std::uint64_t paths = 300;
  PictureObject object{{{-0.01, 0, 0}, {0.01, 0, 0.02}}, {1, 1}, true};
  const PictureScene scene = picture_scene(fog(8, 1.4), std::move(object), {{0, 1, 0}, 0.1, 8});
  const Plan plan = make_plan(scene.scene, ReversedPaths::automatic);
  CHECK(plan.waves.size() > 1);
  std::vector<Complex> found(2 * 64), wanted(2 * 64);
  std::vector<double> intensity(wanted.size());
  const PictureTask task;
  picture_fields(scene, task, paths)(3, found, {});
  fields_by_paths(scene.scene, plan, task.seed, paths)(3, wanted, intensity);
  double error = 0, all = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    error += std::norm(found[i] - wanted[i]);
    all += std::norm(wanted[i]);
  }
  CHECK(all > 0);
  CHECK(error < 1e-20 * all);
}

TEST_CASE("pictures: predicted C_I agrees with the fields of frames") {
  const PictureScene scene = points_behind_fog(true);
  PictureTask task;
  task.prediction_paths = 100000;
  const SpecklePrediction speckle = predicted_speckle(scene, task);
  CHECK(speckle.correlation_at(0) == doctest::Approx(1).epsilon(1e-6));
  CHECK(speckle.grain_x.front() == doctest::Approx(1).epsilon(1e-6));
  // Speckle of a uniform source: the full width of sinc^2 is 0.886 wavelength / width
  CHECK(speckle.grain() == doctest::Approx(0.886 * 0.01 * 320).epsilon(0.2));
  constexpr std::size_t side = 64, pixels = side * side, fields = 12;
  const FieldDraw draw = picture_fields(scene, task, 4000);
  const auto moved = static_cast<std::size_t>(std::lround(0.02 * 320));
  std::vector<double> found;
  for (std::uint64_t number = 0; number < fields; ++number) {
    std::vector<Complex> field(3 * pixels);
    draw(number, field, {});
    double covariance = 0, first = 0, second = 0, means = 0;
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x + moved < side; ++x) {
        const double a = std::norm(field[y * side + x + moved]),
                     b = std::norm(field[pixels + y * side + x]);
        covariance += a * b, first += a, second += b, means += 1;
      }
    found.push_back(covariance * means / (first * second) - 1);
  }
  const auto [mean, variance] = moments_of(found);
  const double error = std::sqrt(variance / (fields - 1));
  CHECK(error < 0.1);
  CHECK(std::abs(mean - speckle.correlation_at(0.02)) < 4 * error + 0.03);
}

TEST_CASE("pictures: predicted mean light agrees with the mean intensity of fields") {
  constexpr std::uint64_t paths = 20000;
  constexpr std::size_t side = 16;
  PictureObject object{{{0.15, 0, 0}}, {1}, true};
  const PictureScene scene = picture_scene(fog(2), std::move(object), {{0, 1, 0}, 0.3, side});
  PictureTask task;
  task.prediction_paths = paths;
  const auto light = predicted_speckle(scene, task).light;
  std::vector<Complex> field(side * side);
  std::vector<double> intensity(field.size());
  const Plan plan = make_plan(scene.scene, ReversedPaths::automatic);
  fields_by_paths(scene.scene, plan, 2, paths)(0, field, intensity);
  const double mean = moments_of(intensity).mean;
  double error = 0, spread = 0;
  for (std::size_t p = 0; p < light.size(); ++p) {
    const double expected = intensity[p] / mean;
    error += std::pow(light[p] - expected, 2);
    spread += std::pow(expected - 1, 2);
  }
  CHECK(spread > 0.05 * static_cast<double>(light.size()));
  CHECK(error < 0.02 * spread);
}

TEST_CASE("points in pictures: places and brightness from a noisy autocorrelation") {
  constexpr std::size_t lags = 40;
  const std::vector<double> x{0, 6.3, 17, 22.6, 30, 31.5}, y{14, 2.2, 27.8, 9, 20, 0},
      brightness{1, 0.8, 1.2, 0.9, 1.3, 0.8};
  PictureStatistics statistics;
  RandomStream random(4, 0, 0);
  statistics.noise = 0.15;
  constexpr long reach = lags - 1;
  for (long row = -reach; row <= reach; ++row)
    for (long column = -reach; column <= reach; ++column) {
      double sum = 0;
      for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t j = 0; j < x.size(); ++j)
          sum += brightness[i] * brightness[j] *
                 std::exp(-std::pow(static_cast<double>(column) - x[i] + x[j], 2) / 4 -
                          std::pow(static_cast<double>(row) - y[i] + y[j], 2) / 4);
      statistics.autocorrelation.push_back(sum + statistics.noise * (2 * random.uniform() - 1));
    }
  const PicturePoints found = picture_points(statistics, lags, x.size(), 3);
  REQUIRE(found.x.size() == x.size());
  CHECK(found.explained > 0.95);
  double off = 1e9, light = 0;
  for (const bool rotated : {false, true}) {
    double most = 0, difference = 0;
    const std::size_t last = x.size() - 1;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::size_t from = rotated ? last - i : i;
      const double wanted_x = rotated ? x[last] - x[from] : x[i],
                   wanted_y = rotated ? y[last] - y[from] : y[i] - y[0];
      most = std::max(most, std::hypot(found.x[i] - wanted_x, found.y[i] - wanted_y));
      difference = std::max(difference, std::abs(found.brightness[i] - brightness[from]));
    }
    if (most < off) off = most, light = difference;
  }
  CHECK(off < 0.5);
  CHECK(light < 0.15);
  CHECK(picture_points(statistics, lags, x.size(), 60).x.empty());
}

TEST_CASE("structural similarity: 1 for proportional pictures, falls with noise") {
  const PictureScene scene = points_behind_fog(false);
  const PictureSize size{24, 24};
  const auto truth = true_picture(scene, 24, 3);
  CHECK(std::reduce(truth.begin(), truth.end()) == doctest::Approx(1));
  auto scaled = truth;
  for (double& value : scaled) value *= 7;
  CHECK(structural_similarity(truth, scaled, size, 3) == doctest::Approx(1));
  const double largest = *std::max_element(truth.begin(), truth.end());
  double before = 1;
  for (const double amplitude : {0.05, 0.2, 0.8}) {
    RandomStream random(2, 0, 0);
    auto noisy = truth;
    for (double& value : noisy) value += amplitude * largest * random.uniform();
    const double similarity = structural_similarity(truth, noisy, size, 3);
    CHECK(similarity < before - 0.05);
    before = similarity;
  }
  const Alignment rotate{1, true, 2, -1};
  CHECK(picture_score(truth, rotate.applied(truth, size), size, 3).similarity > 0.95);
}

TEST_CASE("exposure: frames of motionless scatterers keep their contrast, fast ones lose it") {
  PictureScene scene = points_behind_fog(true);
  PictureTask task;
  task.prediction_paths = 5000;
  task.exposure.delays = {0.25, 0.75};
  task.exposure.motion.diffusion = 0;
  CHECK(predicted_speckle(scene, task).exposure == doctest::Approx(1));
  task.exposure.motion.diffusion = 5000;
  // Two independent patterns
  CHECK(predicted_speckle(scene, task).exposure == doctest::Approx(0.5).epsilon(0.1));
}

}  // namespace flatspeckle::mc::test_pictures
