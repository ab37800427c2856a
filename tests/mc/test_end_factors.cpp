#include <cmath>

#include <doctest/doctest.h>

#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_end_factors {

namespace {

using tests::pi;

template <bool phases>
Complex endpoint_factor(const Scene& scene, const Endpoint& end, Vec x) {
  StraightEndpoints factors(scene, {end}, phases);
  std::vector<Complex> out(1);
  factors.attenuate(x, out);
  return out[0];
}

const double mean_free_path = 3;
const Vec x{0.7, 2.5};

Scene box(double light, View view) {
  return tests::hg_box(6, 4, {mean_free_path}, intensity_request({light}, {view}));
}

}  // namespace

TEST_CASE("endpoint factor: agrees with C13 for a plane wave") {
  const double angle = -0.4;
  const Scene scene = box(angle, far_view(0));
  // backwards along the ray, z = 0 is reached at x = 0.7 + 2.5 tan 0.4 = 1.757, inside the face
  const double behind = 2.5 / std::cos(angle);
  const Complex expected = std::polar(std::exp(-behind / (2 * mean_free_path)),
                                      scene.k * (std::sin(angle) * x.x + std::cos(angle) * x.z));
  CHECK(std::abs(endpoint_factor<true>(scene, light_endpoints(scene)[0], x) - expected) < 1e-13);
  CHECK(std::abs(endpoint_factor<false>(scene, light_endpoints(scene)[0], x) - std::abs(expected)) <
        1e-14);
}

TEST_CASE("endpoint factor: a light equals a view of the opposite direction") {
  for (const double angle : {0.0, 0.4, 1.5, pi / 2, -pi / 2, 2.0, pi}) {
    const Scene scene = box(angle, far_view(angle + pi));
    CHECK(std::abs(endpoint_factor<true>(scene, light_endpoints(scene)[0], x) -
                   endpoint_factor<true>(scene, view_endpoints(scene)[0], x)) < 1e-12);
  }
}

TEST_CASE("endpoint factor: attenuation ends at the boundary or at a nearer sensor") {
  for (const double angle : {0.0, 0.9, pi / 2, -pi / 2, 2.2, pi}) {
    const Scene scene = box(0, far_view(angle));
    const double inside = scene.domain.distance_to_edge(x, direction(angle));
    CAPTURE(angle);
    CHECK(std::abs(endpoint_factor<true>(scene, view_endpoints(scene)[0], x)) ==
          doctest::Approx(std::exp(-inside / (2 * mean_free_path))).epsilon(1e-14));
  }
  for (const Vec sensor : {Vec{0.2, 7}, Vec{-1, 3.5}, Vec{0.75, 2.4}}) {
    const Scene scene = box(0, near_sensor(sensor));
    const double r = length(sensor - x);
    const double inside = std::min(r, scene.domain.distance_to_edge(x, 1 / r * (sensor - x)));
    const Complex expected = std::exp(-inside / (2 * mean_free_path)) * outgoing_wave(scene.k, r);
    const Complex found = endpoint_factor<true>(scene, view_endpoints(scene)[0], x);
    CHECK(std::abs(found - expected) < 1e-13 * std::abs(expected));
    CHECK(std::abs(endpoint_factor<false>(scene, view_endpoints(scene)[0], x) -
                   std::abs(expected)) < 1e-13);
  }
}

}  // namespace flatspeckle::mc::test_end_factors
