#include <cmath>

#include <doctest/doctest.h>

#include "mc/paths/endpoint_factors/coherent_field.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_coherent_field {

namespace {

using tests::pi;

Scene box_of_points(double phase_shift, const CovarianceRequest& request) {
  SceneSpec spec;
  spec.width = 3;
  spec.depth = 2;
  spec.count = 5;
  spec.phase_shift = phase_shift;
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

/// Evaluates C15 by the midpoint rule: rho A int exp(i k (w_i - w_v).x + i (k_eff - k) d).
Complex plane_quadrature(const Scene& scene, double light, double view) {
  constexpr int nx = 480, nz = 320;
  const Domain& box = scene.domain;
  const Vec w = direction(light), v = direction(view);
  const Complex k_eff_minus_k(scene.medium.k_shift, scene.medium.mu_t / 2);
  Complex sum = 0;
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < nz; ++j) {
      const Vec x{box.width * ((i + 0.5) / nx - 0.5), box.depth * (j + 0.5) / nz};
      const double inside = box.distance_to_edge(x, -w);
      sum += std::exp(Complex(0, scene.k * dot(w - v, x)) + Complex(0, 1) * k_eff_minus_k * inside);
    }
  }
  const double cell = box.content() / (nx * nz);
  return scene.medium.density * cell * sum *
         amplitude(scene.medium.t_matrix, scene.k, view - light);
}

}  // namespace

TEST_CASE("coherent field: agrees with C15 for light and views from all sides") {
  const std::vector<double> lights = {0, 0.5, -0.9, 1.5, pi / 2, -pi / 2, 1.7, 2.6, -2.2, pi};
  const std::vector<double> views = {0, 0.5, 0.45, -1.2, pi / 2, 2.6, pi, -2.5};
  for (const double phase_shift : {pi / 2, 0.7}) {
    const Scene scene =
        box_of_points(phase_shift, intensity_request(lights, tests::far_views(views)));
    const auto field = coherent_field(scene);
    const double forward = scene.medium.density * scene.domain.content() *
                           std::abs(amplitude(scene.medium.t_matrix, scene.k, 0));
    for (std::size_t c = 0; c < field.size(); ++c) {
      const double light = lights[scene.request.channels[c].light];
      const double view = views[scene.request.channels[c].view];
      const Complex expected = plane_quadrature(scene, light, view);
      CAPTURE(light);
      CAPTURE(view);
      CHECK(std::abs(field[c] - expected) < 3e-4 * forward);
    }
  }
}

TEST_CASE("coherent field without extinction: equals the Fourier transform of the box") {
  Scene scene =
      box_of_points(1e-4, intensity_request({0.3}, tests::far_views({0.3, 0.35, 1.0, -2})));
  const auto field = coherent_field(scene);
  for (std::size_t c = 0; c < field.size(); ++c) {
    const double view = scene.request.views[c].angle;
    const Vec q = scene.k * (direction(0.3) - direction(view));
    const auto sinc = [](double a) { return a == 0 ? 1 : std::sin(a) / a; };
    const Complex expected = scene.medium.density * scene.domain.content() *
                             amplitude(scene.medium.t_matrix, scene.k, view - 0.3) *
                             std::polar(1.0, q.z * scene.domain.depth / 2) *
                             sinc(q.x * scene.domain.width / 2) *
                             sinc(q.z * scene.domain.depth / 2);
    CHECK(std::abs(field[c] - expected) < 1e-3 * std::abs(field[0]));
  }
}

TEST_CASE("coherent field: accurate in a large box") {
  // light along z: closed forms of the integrals over x and z
  SceneSpec spec;
  spec.width = 2000;
  spec.depth = 1000;
  spec.mean_free_path = 300;
  Scene scene = make_scene(spec);
  scene.request = intensity_request({0}, tests::far_views({0, 1e-4, 0.3, pi}));
  const auto field = coherent_field(scene);
  for (std::size_t c = 0; c < field.size(); ++c) {
    const double view = scene.request.views[c].angle;
    const Vec q = scene.k * (direction(0) - direction(view));
    const double half = q.x * spec.width.value() / 2, depth = spec.depth.value();
    const Complex rate(-scene.medium.mu_t / 2, q.z + scene.medium.k_shift);
    const Complex expected =
        scene.medium.density * amplitude(scene.medium.t_matrix, scene.k, view) * 2000.0 *
        (std::abs(half) < 1e-9 ? 1 : std::sin(half) / half) * (std::exp(rate * depth) - 1.0) / rate;
    CHECK(std::abs(field[c] - expected) < 1e-9 * std::abs(field[0]));
  }
}

TEST_CASE("coherent field: exists only for single scatterers in a box with far views") {
  const auto far = intensity_request({0}, {far_view(0)});
  CHECK(has_coherent_field(box_of_points(1, far)));
  CHECK_FALSE(has_coherent_field(box_of_points(1, intensity_request({0}, {near_sensor({0, 9})}))));
  CHECK_FALSE(has_coherent_field(tests::hg_box(3, 2, {}, far)));
  CHECK_FALSE(has_coherent_field(tests::hg_slab(2, {}, far)));
}

}  // namespace flatspeckle::mc::test_coherent_field
