#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "mc/paths/endpoint_factors/gaussian_beam.h"
#include "mc/paths/walk/first_scatterer.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_near_lights {

namespace {

using tests::pi;

constexpr double k = 2 * pi, width = 6, depth = 4;

Scene box(const Lights& lights, double mean_free_path = 1.5) {
  return tests::hg_box(width, depth, {mean_free_path, 0.6},
                       intensity_request(lights, {far_view(0)}));
}

/// Checks first scatterers on a grid of cells by chi-square.
void check_density(const Scene& scene, std::uint64_t seed) {
  constexpr int columns = 10, rows = 8, fine = 80, samples = 20000;
  const FirstScatterer first(scene);
  std::vector<double> counts(columns * rows), probabilities(columns * rows);
  const double dx = width / (columns * fine), dz = depth / (rows * fine);
  for (int i = 0; i < columns * fine; ++i)
    for (int j = 0; j < rows * fine; ++j)
      probabilities[j / fine * columns + i / fine] +=
          dx * dz * first.density({-width / 2 + (i + 0.5) * dx, (j + 0.5) * dz});
  RandomStream random(seed, 79, 0);
  for (int i = 0; i < samples; ++i) {
    const Vec x = first.sample(random).x;
    REQUIRE(scene.domain.contains(x));
    const int column = static_cast<int>((x.x / width + 0.5) * columns);
    const int row = static_cast<int>(x.z / depth * rows);
    ++counts[std::min(row, rows - 1) * columns + std::min(column, columns - 1)];
  }
  flatspeckle::tests::check_chi_square(counts, probabilities);
}

/// Returns the field of a beam as a sum of plane waves (spectrum at the focus), without evanescent
/// ones.
Complex superposition(const Light& beam, Vec x) {
  constexpr int waves = 4000;
  const double step = 2 * k / waves;
  Complex sum = 0;
  for (int n = 0; n < waves; ++n) {
    const double q = -k + (n + 0.5) * step;
    sum += step * beam.waist / (2 * std::sqrt(pi)) *
           std::exp(-q * q * beam.waist * beam.waist / 4) *
           std::polar(1.0, k * dot(direction(beam.angle + std::asin(q / k)), x - beam.point));
  }
  return sum;
}

}  // namespace

TEST_CASE("paraxial beam: field agrees with a superposition of plane waves") {
  const Light light = gaussian_beam(0.4, {1, 2}, 3);
  const GaussianBeam beam(light, k, 2);
  CHECK(std::abs(beam.field({1, 2}) - 1.0) < 1e-15);
  const Vec rim = Vec{1, 2} + 3.0 * beam.across_axis(0);
  CHECK(std::abs(beam.field(rim)) == doctest::Approx(std::exp(-1.0)).epsilon(1e-12));
  for (const double s : {-30.0, 0.0, 5.0, 30.0}) {
    for (const double t : {-4.0, 0.0, 3.0}) {
      CAPTURE(s);
      CAPTURE(t);
      const Vec x = beam.focus() + s * beam.axis() + t * beam.across_axis(0);
      // the next order of the phase is about k s / (8 (k waist / 2)^4)
      CHECK(std::abs(beam.field(x) - superposition(light, x)) < 0.01);
      CHECK(beam.width(s) ==
            doctest::Approx(3 * std::sqrt(1 + std::pow(2 * s / (k * 9), 2))).epsilon(1e-12));
    }
  }
}

TEST_CASE("beam: ray direction agrees with the gradient of the phase") {
  const GaussianBeam beam(gaussian_beam(-0.7, {1, 2}, 2), k, 2);
  // within the beam, where it is paraxial
  for (const auto& [s, t] : {std::pair{7.0, 1.5}, {20.0, -2.0}, {-20.0, 1.0}}) {
    const Vec x = beam.focus() + s * beam.axis() + t * beam.across_axis(0);
    const double h = 1e-5;
    const auto derivative = [&](Vec along) {
      return std::arg(beam.field(x + h * along) / beam.field(x - h * along)) / (2 * h);
    };
    const Vec gradient{derivative({1, 0}), derivative({0, 1})}, ray = beam.ray(x);
    CHECK(gradient.x / length(gradient) == doctest::Approx(ray.x).epsilon(1e-3));
    CHECK(gradient.z / length(gradient) == doctest::Approx(ray.z).epsilon(1e-3));
  }
}

TEST_CASE("endpoint factors of beams and sources: attenuated inside the medium") {
  const Vec x{0.5, 2.5};
  const auto factor = [&](const Light& light, bool with_phase) {
    const Scene scene = box({light});
    std::vector<Complex> out(1);
    StraightEndpoints(scene, light_endpoints(scene), with_phase).attenuate(x, out);
    return out[0];
  };
  const Light beam = gaussian_beam(0, {0.5, -3}, 2);
  const Complex seen = std::exp(-2.5 / 3) * GaussianBeam(beam, k, 2).field(x);
  CHECK(std::abs(factor(beam, true) - seen) < 1e-13);
  CHECK(std::abs(factor(beam, false) - std::abs(seen)) < 1e-13);
  for (const auto& [source, inside] : {std::pair{Vec{0.5, -5}, 2.5}, {Vec{0.5, 0.5}, 2.0}}) {
    const double r = 2.5 - source.z;
    const Complex expected =
        std::exp(-inside / 3) * std::polar(1 / std::sqrt(8 * pi * k * r), k * r + pi / 4);
    CHECK(std::abs(factor(point_source(source), true) - expected) < 1e-13);
  }
  // at short distance the Green function itself
  const double r = 0.1;
  const Complex green = Complex(0, 0.25) * Complex(::j0(k * r), ::y0(k * r));
  CHECK(std::abs(factor(point_source({0.5, 2.5 - r}), true) - std::exp(-r / 3) * green) < 1e-13);
}

TEST_CASE("first scatterers of point sources: samples follow the density of the weights") {
  std::uint64_t seed = 300;
  for (const double mean_free_path : {1000.0, 1.5})
    for (const Vec source :
         {Vec{0.6, 1.5}, {0, -1}, {0, 9}, {5, 2}, {-7, -6}, {4, 40}, {0, 0}, {-3, 4}}) {
      CAPTURE(source.x);
      CAPTURE(source.z);
      check_density(box({point_source(source)}, mean_free_path), ++seed);
    }
}

TEST_CASE("first scatterers of beams: samples follow the density of the weights") {
  std::uint64_t seed = 400;
  for (const double mean_free_path : {1000.0, 1.5})
    for (const Light& beam :
         {gaussian_beam(0, {0, 0}, 1), gaussian_beam(0.5, {1, 2}, 1), gaussian_beam(0, {0, -60}, 1),
          gaussian_beam(pi / 2, {0, 3}, 1.5), gaussian_beam(2.5, {0, 0}, 2),
          gaussian_beam(0, {5, 0}, 2), gaussian_beam(-0.3, {0, 0}, 1000)}) {
      CAPTURE(beam.angle);
      CAPTURE(beam.point.x);
      CAPTURE(beam.waist);
      check_density(box({beam}, mean_free_path), ++seed);
    }
}

TEST_CASE("first scatterers of sources and beams: position and direction follow the density") {
  const Scene scene =
      box({point_source({0, 1}), point_source({2, -3}), gaussian_beam(0.2, {1, 1}, 1),
           gaussian_beam(0.2, {1.2, 1}, 1), plane_wave(-0.5)});
  CHECK(representative_lights(scene).size() == 4);
  check_density(scene, 500);
  const FirstScatterer first(scene);
  const HenyeyGreensteinScattering scattering{{0.6}};
  const Vec x{0.3, 1.1};
  double sum = 0;
  constexpr int round = 400;
  for (int i = 0; i < round; ++i)
    sum += first.density(x, direction(2 * pi * i / round), scattering);
  CHECK(sum * 2 * pi / round == doctest::Approx(first.density(x)).epsilon(1e-9));
}

TEST_CASE("beam: rejected if it misses the medium") {
  CHECK_THROWS_AS(FirstScatterer(box({gaussian_beam(0, {20, 0}, 1)})), InputError);
  CHECK_NOTHROW(FirstScatterer(box({gaussian_beam(0, {4, 0}, 1)})));
}

}  // namespace flatspeckle::mc::test_near_lights
