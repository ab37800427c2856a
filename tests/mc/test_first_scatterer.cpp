#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "mc/paths/walk/first_scatterer.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_first_scatterer {

namespace {

using tests::pi;

/// Directions from the front, both sides and behind: axial, oblique and grazing.
const std::vector<double> directions = {0, 0.5, -1.2, pi / 2, -pi / 2, 1.55, 2.5, -2.8, pi};

constexpr double width = 6, depth = 4;
constexpr int columns = 10, rows = 8;

/// Returns the probability of a first scatterer in a cell by the density at a fine grid of points
/// (it is 1/chord in corners).
double cell_probability(const FirstScatterer& first, int column, int row) {
  constexpr int grid = 80;
  const double dx = width / (columns * grid), dz = depth / (rows * grid);
  double sum = 0;
  for (int a = 0; a < grid; ++a) {
    for (int b = 0; b < grid; ++b) {
      const Vec x{-width / 2 + (column * grid + a + 0.5) * dx, (row * grid + b + 0.5) * dz};
      sum += first.density(x);
    }
  }
  return sum * dx * dz;
}

std::vector<double> counts_per_cell(const Scene& scene, const FirstScatterer& first,
                                    std::uint64_t seed) {
  RandomStream random(seed, 79, 0);
  std::vector<double> counts(columns * rows);
  int outside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec x = first.sample(random).x;
    if (scene.domain.distance_to_edge(x, {0, 1}) > depth * (1 + 1e-12)) ++outside;
    const int column = static_cast<int>((x.x / width + 0.5) * columns);
    const int row = static_cast<int>(x.z / depth * rows);
    ++counts[std::clamp(row, 0, rows - 1) * columns + std::clamp(column, 0, columns - 1)];
    if (std::abs(x.x) > width / 2 * (1 + 1e-12)) ++outside;
  }
  CHECK(outside == 0);
  return counts;
}

}  // namespace

TEST_CASE("first scatterers in a box: samples follow the density of the weights") {
  std::uint64_t seed = 0;
  for (const double mean_free_path : {1000.0, 1.5}) {
    for (const double light : directions) {
      CAPTURE(light);
      CAPTURE(mean_free_path);
      const Scene scene =
          tests::hg_box(width, depth, {mean_free_path}, intensity_request({light}, {far_view(0)}));
      const FirstScatterer first(scene);
      std::vector<double> probabilities;
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
          probabilities.push_back(cell_probability(first, column, row));
      flatspeckle::tests::check_chi_square(counts_per_cell(scene, first, ++seed), probabilities);
    }
  }
}

TEST_CASE("first scatterers in a slab: sampled depths follow the density of the weights") {
  std::uint64_t seed = 100;
  for (const double light : {0.0, -0.8, 1.5}) {
    for (const double optical_depth : {1e-3, 3.0}) {
      const Scene scene =
          tests::hg_slab(depth, {depth / optical_depth}, intensity_request({light}, {far_view(0)}));
      const FirstScatterer first(scene);
      RandomStream random(++seed, 79, 0);
      // in a thick slab only as deep as light penetrates
      constexpr int bins = 20;
      const double seen = std::min(depth, 8 * std::cos(light) * depth / optical_depth);
      std::vector<double> counts(bins), probabilities;
      for (int i = 0; i < 20000; ++i) {
        const double z = first.sample(random).x.z;
        if (z < seen) ++counts[static_cast<int>(z / seen * bins)];
      }
      for (int bin = 0; bin < bins; ++bin) {
        probabilities.push_back(flatspeckle::tests::integral(
            [&](double z) {
              return first.density({0, z});
            },
            seen * bin / bins, seen * (bin + 1) / bins));
      }
      CAPTURE(light);
      CAPTURE(optical_depth);
      flatspeckle::tests::check_chi_square(counts, probabilities);
    }
  }
}

TEST_CASE("first scatterers guided by importance: samples follow the density of the weights") {
  std::uint64_t seed = 200;
  for (const double gradient : {0.4, -0.4, 3.0}) {
    for (const double light : {0.3, 2.9}) {
      CAPTURE(gradient);
      CAPTURE(light);
      const Scene scene =
          tests::hg_box(width, depth, {1}, intensity_request({light}, {far_view(0)}));
      const FirstScatterer first(scene, gradient);
      std::vector<double> probabilities;
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
          probabilities.push_back(cell_probability(first, column, row));
      flatspeckle::tests::check_chi_square(counts_per_cell(scene, first, ++seed), probabilities);
    }
  }
  // deeper towards larger importance, unchanged away from it
  const Scene scene = tests::hg_slab(10, {1}, intensity_request({0}, {far_view(0)}));
  const double plain = FirstScatterer(scene).density({0, 8});
  CHECK(FirstScatterer(scene, 0.5).density({0, 8}) > 10 * plain);
  CHECK(FirstScatterer(scene, -0.5).density({0, 8}) == plain);
}

TEST_CASE(
    "first scatterers of several lights: position and direction follow the weights' density") {
  const Scene scene = tests::hg_box(width, depth, {1.5, 0.6},
                                    intensity_request({0, 0.05, 0.4, -1.2}, {far_view(0)}));
  CHECK(representative_lights(scene) == Lights{0.0, -1.2, 0.4, 0.05});
  const FirstScatterer first(scene);
  std::vector<double> probabilities;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      probabilities.push_back(cell_probability(first, column, row));
  flatspeckle::tests::check_chi_square(counts_per_cell(scene, first, 500), probabilities);

  // The density of position and direction, integrated over directions, is that of position.
  const HenyeyGreensteinScattering scattering{{0.6}};
  const Vec x{0.3, 1.1};
  double sum = 0;
  constexpr int directions_round = 400;
  for (int i = 0; i < directions_round; ++i)
    sum += first.density(x, direction(2 * pi * i / directions_round), scattering);
  CHECK(sum * 2 * pi / directions_round == doctest::Approx(first.density(x)).epsilon(1e-12));
}

}  // namespace flatspeckle::mc::test_first_scatterer
