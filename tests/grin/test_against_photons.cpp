#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "grin/render/pictures/render_datasets.h"
#include "tests/grin/photon_comparison.h"
#include "tests/grin/render_tests.h"
#include "tests/grin/seen_from_outside.h"

// Compares the estimators with analog photon tracing, on detectors that photons hit.

namespace flatspeckle::grin::tests::test_against_photons {

using namespace oracles;

namespace {

constexpr double pi = std::numbers::pi;

/// Returns weakly absorbing fog in a sphere of index 1.3 with an off-centre point light; a cap of
/// the wall detects pulses.
TwoScenes foggy_sphere() {
  const AreaDetector cap{.centre = {0, 0, 1},
                         .up = {0, 1, 0},
                         .width = 1.2,
                         .height = 0.8,
                         .pixels = {3, 2},
                         .acceptance = pi / 2};
  const Vec3 light(0.2, -0.1, -0.4);
  return {.scene = {.field = Homogeneous{0.3},
                    .step = 0.1,
                    .max_length = 100,
                    .stage = {.boundary = Sphere{},
                              .medium = {.mu_s = 2.5, .mu_a = 0.3, .phase = {HgPhase{0.6}}}},
                    .lights = {PointLight{.x = light, .power = 3}},
                    .sensors = {cap},
                    .bins = {1.5, 4.5, 5}},
          .walk = {.boundary = {Vec3::Zero(), Vec3::Zero(), 1},
                   .medium = {.mu_s = 2.5,
                              .mu_a = 0.3,
                              .law = WalkMedium::Law::henyey_greenstein,
                              .g = 0.6},
                   .around = 1.3},
          .source = point_source(light),
          .power = 3,
          .sensor = area_sensor(cap, {0, 0, 1}, 1)};
}

/// Returns a scattering glass ball in thin fog under an off-centre beam, detected by direction.
TwoScenes glass_ball() {
  const DirectionalDetector far{
      .forward = {0, 0, 1}, .up = {0, 1, 0}, .half_angle = 0.6, .pixels = {3, 3}};
  return {.scene = {.field = Homogeneous{0.5},
                    .step = 0.1,
                    .max_length = 100,
                    .stage = {.boundary = Box{{-2, -2, -2}, {2, 2, 2}},
                              .medium = {.mu_s = 0.3},
                              .bodies = std::vector<Body>(
                                  1, {Sphere{{0.1, 0, 0}, 1},
                                      {.mu_s = 0.8, .mu_a = 0.1, .phase = {RayleighPhase{}}}})},
                    .lights = {BeamLight{{0, 0, -2}, {0, 0, 1}, 0.7}},
                    .sensors = {far}},
          .walk = {.boundary = {{-2, -2, -2}, {2, 2, 2}},
                   .medium = {.mu_s = 0.3},
                   .balls = {{{0.1, 0, 0},
                              1,
                              {.mu_s = 0.8, .mu_a = 0.1, .law = WalkMedium::Law::rayleigh},
                              1.5}}},
          .source = beam_source({0, 0, -2}, {0, 0, 1}, 0.7),
          .sensor = directional_sensor(far)};
}

/// Returns a scattering Luneburg ball under a beam, detected by position behind it.
TwoScenes luneburg_ball() {
  const AreaDetector wall{.centre = {0, 0, 1.5},
                          .up = {0, 1, 0},
                          .width = 2,
                          .height = 2,
                          .pixels = {3, 3},
                          .acceptance = 1.0};
  const auto n = [](const Vec3& x) { return std::sqrt(2 - x.squaredNorm()); };
  return {.scene = {.field = Luneburg({}),
                    .step = 0.1,
                    .max_length = 100,
                    .stage = {.boundary = Box{{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}},
                              .medium = {.mu_s = 0.1},
                              .bodies = std::vector<Body>(
                                  1, {Sphere{}, {.mu_s = 0.7, .phase = {HgPhase{0.5}}}})},
                    .lights = {BeamLight{{0, 0, -1.5}, {0, 0, 1}, 0.8}},
                    .sensors = {wall}},
          .walk = {.boundary = {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}},
                   .medium = {.mu_s = 0.1},
                   .balls = {{Vec3::Zero(),
                              1,
                              {.mu_s = 0.7, .law = WalkMedium::Law::henyey_greenstein, .g = 0.5}}},
                   .curved = WalkIndex{n, [=](const Vec3& x) { return Vec3(-x / n(x)); }, 0.05}},
          .source = beam_source({0, 0, -1.5}, {0, 0, 1}, 0.8),
          .sensor = area_sensor(wall, {0, 0, 1})};
}

/// Returns a guide n^2 = n0^2 - alpha^2 rho^2 whose fog grows denser along the axis; a beam enters
/// at one end, pulses are detected at the other.
TwoScenes foggy_guide() {
  constexpr double n0 = 1.5, alpha = 0.5;
  const AreaDetector end{.centre = {0, 0, 4},
                         .up = {0, 1, 0},
                         .width = 2,
                         .height = 2,
                         .pixels = {2, 1},
                         .acceptance = pi / 2};
  // linear between the nodes, like the density of the photon walk
  const FieldGrid nodes{.origin = {-1, -1, 0}, .spacing = {2, 2, 4}, .nodes = {2, 2, 2}};
  const auto density = std::make_shared<DensityGrid>(
      nodes, std::vector<double>{0.5, 1.5, 0.5, 1.5, 0.5, 1.5, 0.5, 1.5});
  const auto n = [](const Vec3& x) {
    return std::sqrt(n0 * n0 - alpha * alpha * (x.x() * x.x() + x.y() * x.y()));
  };
  const auto gradient = [n](const Vec3& x) {
    return Vec3(-alpha * alpha / n(x) * Vec3(x.x(), x.y(), 0));
  };
  return {.scene = {.field = ParabolicGuide({n0 - 1, alpha}),
                    .step = 0.1,
                    .max_length = 100,
                    .stage = {.boundary = Box{{-1, -1, 0}, {1, 1, 4}},
                              .medium = {.mu_s = 0.3, .mu_a = 0.05, .density = density}},
                    .lights = {BeamLight{{0.2, 0, 0.2}, {0.2, 0, 1}, 0.3}},
                    .sensors = {end},
                    .bins = {5, 8, 4}},
          .walk = {.boundary = {{-1, -1, 0}, {1, 1, 4}},
                   .medium = {.mu_s = 0.3,
                              .mu_a = 0.05,
                              .density = [](const Vec3& x) { return 0.5 + x.z() / 4; },
                              .largest_density = 1.5},
                   .curved = WalkIndex{n, gradient, 0.05}},
          .source = beam_source({0.2, 0, 0.2}, {0.2, 0, 1}, 0.3),
          .sensor = area_sensor(end, {0, 0, 1})};
}

/// Returns a thick slab of tissue under a narrow beam, for diffuse reflectance by radius or angle.
TwoScenes tissue(const Sensor& sensor, const PhotonSensor& seen) {
  return {.scene = {.field = Homogeneous{},
                    .step = 1,
                    .max_length = 1e6,
                    .stage = {.boundary = Box{{-30, -30, 0}, {30, 30, 10}},
                              .medium = {.mu_s = 5, .mu_a = 0.05, .phase = {HgPhase{0.8}}}},
                    .lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 0.1}},
                    .sensors = {sensor},
                    .bins = {.moments = true}},
          .walk = {.boundary = {{-30, -30, 0}, {30, 30, 10}},
                   .medium = {.mu_s = 5,
                              .mu_a = 0.05,
                              .law = WalkMedium::Law::henyey_greenstein,
                              .g = 0.8}},
          .source = beam_source({0, 0, 0}, {0, 0, 1}, 0.1),
          .sensor = seen};
}

/// Replaces the beam by a luminous disk on the wall at z, in a medium of this index.
TwoScenes with_face_light(TwoScenes scenes, double z, double index) {
  const double radius = 0.9;
  scenes.scene.lights = {FaceLight{.centre = {0, 0, z}, .radius = radius, .radiance = 2}};
  scenes.source = lambertian_source({0, 0, z}, {0, 0, 1}, radius);
  scenes.power = 2 * pi * index * index * pi * radius * radius;
  return scenes;
}

constexpr RenderMethod two_methods[] = {RenderMethod::light, RenderMethod::bidirectional};
constexpr RenderMethod three_methods[] = {RenderMethod::path, RenderMethod::light,
                                          RenderMethod::bidirectional};

void check_methods(const TwoScenes& scenes, std::span<const RenderMethod> methods,
                   std::uint64_t photons, double precision, std::uint64_t samples) {
  const PhotonPicture picture = photon_picture(scenes, photons, 5);
  for (const RenderMethod method : methods)
    check_against(picture, scenes, {.method = method}, samples, precision);
}

}  // namespace

// Path tracing is left out near a point light in fog and under a beam: it connects their first
// collisions by 1/r^2 alone, so that its variance is infinite.

TEST_CASE("point light in a foggy sphere: pulses agree with analog photon tracing") {
  check_methods(foggy_sphere(), two_methods, 400000, 0.01, 250000);
}

TEST_CASE("glass ball in fog under a beam: pictures agree with analog photon tracing") {
  check_methods(glass_ball(), two_methods, 400000, 0.02, 200000);
}

TEST_CASE("glass ball in fog before a luminous wall: pictures agree with analog photon tracing") {
  check_methods(with_face_light(glass_ball(), -2, 1), three_methods, 400000, 0.02, 200000);
}

TEST_CASE("Luneburg ball in fog under a beam: pictures agree with analog photon tracing") {
  check_methods(luneburg_ball(), two_methods, 100000, 0.03, 30000);
}

TEST_CASE(
    "Luneburg ball in fog before a luminous wall: pictures agree with analog photon tracing") {
  check_methods(with_face_light(luneburg_ball(), -1.5, 1), three_methods, 100000, 0.03, 30000);
}

TEST_CASE("foggy guide under a beam: pulses agree with analog photon tracing") {
  check_methods(foggy_guide(), two_methods, 100000, 0.03, 30000);
}

TEST_CASE(
    "tissue slab: reflectance by radius and moments of its paths agree with analog photon "
    "tracing") {
  const RadialDetector rings{{0, 0, 0}, 5, 5, 1};
  const TwoScenes scenes = tissue(rings, radial_sensor(rings, {0, 0, -1}));
  check_methods(scenes, two_methods, 200000, 0.03, 24000);

  // mean optical path of each ring, and mean of its square
  const double share = flatspeckle::tests::effort().samples;
  const RenderJob job = render_job(scenes.scene, {.method = RenderMethod::light}, 3);
  const SensorResult found =
      render_result(scenes.scene, job, run_render(job, share * 100000).sums).front();
  const auto mean = [&](int ring, int power) {
    return found.pixel_paths.value[2 * ring + power - 1].real();
  };
  const auto photons = static_cast<std::uint64_t>(share * 400000);
  PhotonTally light(rings.rings, photons);
  std::vector<PhotonTally> beyond(2, light);  // excess of the photons' moments over the estimates
  walk_photons(scenes.walk, scenes.source, photons, 6, [&](const Photon& p) {
    const auto seen = scenes.sensor(p);
    if (!seen) return;
    light.add(seen->pixel, seen->score);
    for (const int power : {1, 2})
      beyond[power - 1].add(
          seen->pixel, seen->score * (std::pow(p.optical_path, power) - mean(seen->pixel, power)));
  });
  for (int ring = 0; ring < rings.rings; ++ring)
    for (const int power : {1, 2}) {
      const double off = beyond[power - 1].mean(ring) / light.mean(ring);
      const double error = std::hypot(beyond[power - 1].error(ring) / light.mean(ring),
                                      found.pixel_paths.error[2 * ring + power - 1]);
      CAPTURE(ring);
      CAPTURE(mean(ring, power));
      CHECK(std::abs(off) < 4 * error);
      CHECK(error < 0.07 * mean(ring, power));
    }
}

TEST_CASE("tissue slab: reflectances by polar angle agree with analog photon tracing") {
  const PolarDetector rings{{0, 0, -1}, pi / 2, 6};
  check_methods(tissue(rings, polar_sensor(rings)), two_methods, 200000, 0.02, 24000);
}

TEST_CASE(
    "scattering glass ball: a lens camera agrees with analog photons, a pinhole with the lens") {
  std::vector<double> indices;              // by day only the beam
  if (is_night) indices = {1.0, 1.4, 0.8};  // n = 0.8: few paths connect, with small weights
  for (const double index : indices)
    check_lens_and_pinhole(body_from_outside(Homogeneous{index - 1}, ball_walk(index), side_point,
                                             towards_ball(), share_towards_ball),
                           3000000, 400000, index < 1 ? 0.15 : 0.03);
  check_lens_and_pinhole(body_from_outside(Homogeneous{0.4}, ball_walk(1.4), side_beam,
                                           beam_source({0, 0, -1.9}, {0, 0, 1}, 0.8)),
                         is_night ? 12000000 : 6000000, is_night ? 200000 : 100000);
}

TEST_CASE(
    "scattering Luneburg ball: a lens camera agrees with analog photons, a pinhole with the lens") {
  const WalkScene walk = luneburg_walk();
  check_lens_and_pinhole(
      body_from_outside(Luneburg({}), walk, side_point, towards_ball(), share_towards_ball), 400000,
      100000);
  if (!is_night) return;
  check_lens_and_pinhole(
      body_from_outside(Luneburg({}), walk, side_beam, beam_source({0, 0, -1.9}, {0, 0, 1}, 0.8)),
      600000, 50000);
}

}  // namespace flatspeckle::grin::tests::test_against_photons
