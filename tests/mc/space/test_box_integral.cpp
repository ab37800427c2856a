// Single scattering and the mean field in a box in space.
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "mc/paths/endpoint_factors/box_integral.h"
#include "mc/paths/endpoint_factors/coherent_field.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_box_integral {

namespace {

using tests::pi;

constexpr Domain box{Domain::Kind::box, 3, 2, 2.5};

/// Evaluates the integral by the midpoint rule, extrapolated from two grids.
Complex by_midpoints(Complex mu_t, Vec kappa, const std::vector<Vec>& towards, int cells) {
  Complex sum = 0;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (int l = 0; l < cells; ++l) {
        const Vec x{box.width * ((i + 0.5) / cells - 0.5), box.depth * (j + 0.5) / cells,
                    box.height * ((l + 0.5) / cells - 0.5)};
        double length = 0;
        for (const Vec w : towards) length += box.distance_to_edge(x, w);
        sum += std::exp(Complex(0, dot(kappa, x)) - mu_t * length / 2.0);
      }
  return box.content() / std::pow(cells, 3) * sum;
}

}  // namespace

TEST_CASE("box in space: the integral of an attenuated wave agrees with the midpoint rule") {
  const Vec directions[] = {direction(0.4, 1),        direction(2.5, -2), direction(pi / 2, 0.3),
                            direction(0.4001, 1.001), direction(1.1, 4),  {0, -1}};
  int number = 0;
  for (const Vec kappa : {Vec{}, Vec{1, 2, -0.5}, Vec{3, -1, 2}})
    for (const Complex mu_t : {Complex(0.7, 0), Complex(2, -0.4)}) {
      CAPTURE(number);
      const auto towards = [&](int i) { return directions[(number + i) % 6]; };
      const std::vector<Vec> four{towards(0), towards(1), towards(0), towards(3)};
      const Complex found = attenuated_wave_integral(box, mu_t, kappa, four);
      const Complex coarse = by_midpoints(mu_t, kappa, four, 30),
                    fine = by_midpoints(mu_t, kappa, four, 60);
      CHECK(std::abs(found - (4.0 * fine - coarse) / 3.0) < 1e-4 * box.content());
      ++number;
    }
}

TEST_CASE("box in space: with rays in the plane the integral is the height times the plane's") {
  const Domain plane{Domain::Kind::box, box.width, box.depth};
  for (const double kappa_y : {0.0, 1.3, 400.0}) {
    const std::vector<Vec> towards{direction(0.3), direction(-2), direction(0.31), direction(-1.9)};
    const Complex found = attenuated_wave_integral(box, 1.5, {2, -60, kappa_y}, towards);
    const double half = kappa_y * box.height / 2, sinc = half == 0 ? 1 : std::sin(half) / half;
    const Complex expected =
        box.height * sinc * attenuated_wave_integral(plane, 1.5, {2, -60}, towards);
    CHECK(std::abs(found - expected) < 1e-9);
  }
}

TEST_CASE("divided differences of exp: agree with closed forms for near and far points") {
  const auto exact = [](Complex a) {  // of 0, 0, 0 and a
    return (std::exp(a) - 1.0 - a - a * a / 2.0) / (a * a * a);
  };
  for (const Complex a : {Complex(0.9, 0.2), Complex(-3, 1), Complex(-40, 0), Complex(0, 1000)}) {
    const Complex points[] = {0, a, 0, 0};
    CHECK(std::abs(divided_difference(points) / exact(a) - 1.0) < 1e-12);
  }
  const Complex same[] = {-2, -2, -2, -2}, close[] = {-2, -2.0 + 1e-9, -2, -2};
  CHECK(std::abs(divided_difference(same) - std::exp(-2) / 6) < 1e-16);
  CHECK(std::abs(divided_difference(close) - std::exp(-2) / 6 * (1 + 1e-9 / 4)) < 1e-16);
}

TEST_CASE("coherent field in space: agrees with C15 by the midpoint rule") {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = 1.5;
  spec.height = 1;
  spec.depth = 1;
  spec.count = 5;
  spec.phase_shift = 0.7;
  Scene scene = mc::in_space(make_scene(spec), spec);
  scene.request = intensity_request(Lights{plane_wave(0.5, 1), plane_wave(2.2, -2)},
                                    {far_view(0.4, 1.1), far_view(1.3, 3), far_view(2.9)});
  const auto field = coherent_field(scene);
  const Complex k_eff_minus_k(scene.medium.k_shift, scene.medium.mu_t / 2);
  const double forward = scene.medium.density * scene.domain.content() *
                         std::abs(amplitude_in_space(scene.medium.t_matrix, scene.k, 1));
  const auto sum = [&](Vec w, Vec v, int cells) {
    Complex total = 0;
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j)
        for (int l = 0; l < cells; ++l) {
          const Vec x{1.5 * ((i + 0.5) / cells - 0.5), (j + 0.5) / cells, (l + 0.5) / cells - 0.5};
          total += std::exp(Complex(0, 1) * (scene.k * dot(w - v, x) +
                                             k_eff_minus_k * scene.domain.distance_to_edge(x, -w)));
        }
    return 1.5 / std::pow(cells, 3) * total;
  };
  for (std::size_t c = 0; c < field.size(); ++c) {
    const auto [light, view] = scene.request.channels[c];
    const Vec w = scene.request.lights[light].direction(),
              v = scene.request.views[view].direction();
    const Complex expected = scene.medium.density *
                             amplitude_in_space(scene.medium.t_matrix, scene.k, dot(w, v)) *
                             (4.0 * sum(w, v, 60) - sum(w, v, 30)) / 3.0;
    CAPTURE(c);
    CHECK(std::abs(field[c] - expected) < 1e-4 * forward);
  }
}

}  // namespace flatspeckle::mc::test_box_integral
