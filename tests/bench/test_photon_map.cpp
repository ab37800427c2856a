#include <algorithm>
#include <cmath>
#include <numbers>

#include <boost/math/quadrature/gauss.hpp>
#include <doctest/doctest.h>

#include "bench/baselines/photon_map.h"
#include "bench/scenes/meshes.h"
#include "tests/grin/render_tests.h"

namespace flatspeckle::bench::test_photon_map {

using namespace grin;
using namespace grin::tests;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double everywhere = std::numeric_limits<double>::infinity();

template <class F>
double smooth_integral(const F& f, double from, double to) {
  return boost::math::quadrature::gauss<double, 20>::integrate(f, from, to);
}

/// A camera with one pixel that looks along +z.
Camera pinhole(const Vec3& x) {
  return {.x = x, .forward = {0, 0, 1}, .up = {0, 1, 0}, .field_of_view = 2.8, .pixels = {}};
}

RenderScene furnace(const AnyIndexField& field, const ScatteringMedium& medium) {
  return {.field = field,
          .step = 0.1,
          .max_length = 100,
          .stage = {.boundary = Sphere{}, .medium = medium},
          .lights = {FaceLight{.radius = everywhere}},
          .sensors = {pinhole(Vec3::Zero())}};
}

/// Returns the expected value of a camera in the centre of the unit sphere. In a furnace L/n^2 = 1,
/// so the blur has only two effects: photons beyond the wall are missing, and points with different
/// index are mixed.
template <class Index>
double blurred_furnace(const Index& n, double mu, double radius) {
  const auto gathered = [&](double s) {
    // the gather sphere around a point at distance s from the centre is integrated over shells and
    // polar angles
    const auto shell = [&](double r) {
      const auto ring = [&](double cosine) {
        const double from_centre = std::sqrt(s * s + r * r + 2 * s * r * cosine);
        const double ratio = n(from_centre) / n(s);
        return from_centre < 1 ? ratio * ratio : 0;
      };
      // the integration ends at the wall, so the integrand is smooth
      const double wall = std::clamp((1 - s * s - r * r) / (2 * s * r), -1.0, 1.0);
      return 2 * pi * r * r * smooth_integral(ring, -1, wall);
    };
    return smooth_integral(shell, 0, radius) / (4 * pi / 3 * std::pow(radius, 3));
  };
  const auto collided = [&](double s) { return mu * std::exp(-mu * s) * gathered(s); };
  return std::exp(-mu) + smooth_integral(collided, 1e-9, 1 - radius) +
         smooth_integral(collided, 1 - radius, 1);
}

Estimate estimated(const BatchJob& job, double samples) {
  RunState state{GroupedSums(job.size), {}};
  RunOptions options;
  options.stop = after(samples);
  run_batches(job, options, state);
  return jackknife(state.sums, sample_mean);
}

/// Estimate of a single pixel by the photon map.
struct Mapped {
  Estimate pixel;
  double value() const { return pixel.value[0].real(); }
  double error() const { return pixel.error[0]; }
};
Mapped mapped(const RenderScene& scene, double radius, double samples, std::uint64_t seed = 1) {
  return {estimated(photon_map_job(scene, radius, seed), samples)};
}

/// Compares a furnace with its expected value. Many small maps are used, because the number of
/// pairs grows with the square of the map's size.
void check_furnace(const RenderScene& scene, double radius, double expected) {
  constexpr int paths = 1024;
  const flatspeckle::tests::Effort effort = flatspeckle::tests::effort();
  const Mapped mean{
      estimated(photon_map_job(scene, radius, 1, paths), 80 * effort.samples * paths)};
  const double value = mean.value(), error = mean.error();
  CAPTURE(value);
  CAPTURE(error);
  CAPTURE(expected);
  CHECK(error < 0.02 * effort.errors * expected);
  CHECK(std::abs(value - expected) < 4 * error);
}

}  // namespace

TEST_CASE("gather grid: each point within the radius is found once") {
  RandomStream random(3, 9, 0);
  const auto anywhere = [&](double scale) {
    return Vec3(scale * (random.uniform() - 0.5), scale * (random.uniform() - 0.5),
                scale * (random.uniform() - 0.5));
  };
  // with few points there are few buckets, so several cells share a bucket
  for (const auto& [scale, count] : {std::pair(0.05, 500), {1.0, 500}, {2.0, 20}, {30.0, 500}}) {
    std::vector<GatherPoint> points(count);
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i].x = anywhere(scale);
      points[i].pixel = static_cast<int>(i);
    }
    const double radius = 0.3;
    const GatherGrid grid(points, radius);
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3 x =
          trial % 2 ? anywhere(1.2 * scale) : Vec3(points[trial % count].x + anywhere(0.4));
      std::vector<int> expected, found;
      for (const GatherPoint& p : points)
        if ((p.x - x).norm() < radius) expected.push_back(p.pixel);
      grid.near(x, [&](const GatherPoint& p) { found.push_back(p.pixel); });
      std::sort(found.begin(), found.end());
      CHECK(found == expected);
    }
  }
}

TEST_CASE("photon map: furnace agrees with the blurred closed form") {
  const double mu = 1.5, n = 1.4;
  const RenderScene scene = furnace(Homogeneous{n - 1}, {.mu_s = mu, .phase = {HgPhase{0.6}}});
  for (const double radius : {0.35, 0.15}) {
    const double expected = blurred_furnace([&](double) { return n; }, mu, radius);
    CHECK(expected < 1 - 0.06 * radius);
    check_furnace(scene, radius, expected);
  }
}

TEST_CASE("photon map: L/n^2 in a fisheye agrees with the blurred closed form") {
  const double mu = 1.5, radius = 0.25;
  const RenderScene scene = furnace(Fisheye({.centre_excess = 1, .radius = 0.6}),
                                    {.mu_s = mu, .phase = {RayleighPhase{}}});
  const double expected =
      blurred_furnace([](double r) { return 2 / (1 + r * r / 0.36); }, mu, radius);
  CHECK(std::abs(expected - blurred_furnace([](double) { return 1; }, mu, radius)) > 0.04);
  check_furnace(scene, radius, expected);
}

TEST_CASE("photon map: photons inside another body do not contribute") {
  // Fog around an absorbing ball: the camera sees only fog beside it; photons inside the ball, none
  // of which leaves, must not contribute.
  const auto scene_of = [](double mu_s_of_ball) {
    RenderScene scene = furnace(Homogeneous{}, {.mu_s = 0.5});
    scene.stage.bodies = {
        {Sphere{{0, 0, 0.5}, 0.3}, {.mu_s = mu_s_of_ball, .mu_a = 1000 - mu_s_of_ball}}};
    return scene;
  };
  const Mapped black = mapped(scene_of(0), 0.2, 200000);
  const Mapped dark = mapped(scene_of(1e-6), 0.2, 200000, 2);
  const double error = std::hypot(black.error(), dark.error());
  CHECK(std::abs(black.value() - dark.value()) < 4 * error);
  CHECK(error < 0.02 * black.value());
}

namespace {

/// A beam through fog, optionally with a ball in it that refracts the beam.
RenderScene beam_in_fog(bool ball) {
  RenderScene scene{};
  scene.step = 0.1;
  scene.max_length = 100;
  scene.stage.boundary = Box{{-2, -2, -2}, {2, 2, 2}};
  scene.stage.medium.mu_s = 0.3;
  scene.stage.medium.mu_a = 0.05;
  scene.stage.medium.phase = {HgPhase{0.5}};
  if (ball) {
    Body body;
    body.surface = Sphere{};
    body.medium.mu_s = 0.5;
    scene.field = Luneburg({});
    scene.stage.bodies = {body};
  }
  scene.lights = {BeamLight{{0, 0, -2}, {0, 0, 1}, 0.3}};
  // A patch of the side wall receives light at nearly normal incidence from the beam. Light that
  // leaves the ball can only hit sensors, so there the sensor measures all light that leaves to the
  // side.
  scene.sensors = {AreaDetector{{2, 0, 0.3}, {0, 1, 0}, 0.5, 0.3, {}, 0.3}};
  if (ball) scene.sensors = {DirectionalDetector{{1, 0, 0}, {0, 1, 0}, 0.8, {}}};
  return scene;
}

/// Sound that bends the beam noticeably, with an independent phase for each path.
RenderScene beam_in_sound() {
  RenderScene scene = beam_in_fog(false);
  scene.field = FocusedSound(0.3, 0.15, 4, cap_directions(4, 0.9), Vec3(0, 0, 0.3));
  scene.random_phase = true;
  scene.step = 0.2;
  scene.sensors = {AreaDetector{{2, 0, 0.3}, {0, 1, 0}, 1, 1, {}, 0.6}};
  return scene;
}

/// The beam in a stage whose boundary is a mesh; a camera inside looks across.
RenderScene beam_in_mesh() {
  RenderScene scene = beam_in_fog(false);
  scene.stage.boundary = bench::smooth(bench::cube_mesh(2), 0.2);
  scene.lights = {BeamLight{{0, 0, -1.9}, {0, 0, 1}, 0.3}};
  scene.sensors = {Camera{.x = {1.5, 0, 0.3},
                          .forward = {-1, 0, 0},
                          .up = {0, 1, 0},
                          .field_of_view = 0.3,
                          .pixels = {}}};
  return scene;
}

/// Checks that the photon map converges to an unbiased method as its radius shrinks.
void check_shrinking(const RenderScene& scene, RenderMethod method, double exact_samples,
                     double samples) {
  const Rendered exact = rendered(scene, method, exact_samples);
  const auto at = [&](double radius) { return mapped(scene, radius, samples); };
  const Mapped wide = at(0.4), half = at(0.2), quarter = at(0.1);
  const double reference = exact.value();
  CAPTURE(reference);
  CAPTURE(exact.error());
  CAPTURE(wide.value());
  CAPTURE(wide.error());
  CAPTURE(half.value());
  CAPTURE(half.error());
  CAPTURE(quarter.value());
  CAPTURE(quarter.error());
  // the widest map is strongly blurred
  CHECK(std::abs(wide.value() - reference) > 4 * std::hypot(wide.error(), exact.error()));
  CHECK(std::abs(quarter.value() - reference) < 0.5 * std::abs(wide.value() - reference));
  // extrapolation that removes the terms in radius^2 and, approximately, radius^3
  const double limit = (4 * quarter.value() - half.value()) / 3;
  const double error = std::hypot(4 * quarter.error(), half.error()) / 3;
  CAPTURE(limit);
  CAPTURE(error);
  CHECK(error < 0.05 * reference);
  CHECK(std::abs(limit - reference) < 4 * std::hypot(error, exact.error()));
}

}  // namespace

TEST_CASE("photon map: converges to bidirectional tracing as its radius shrinks") {
  for (const bool ball : {false, true}) {
    if (ball && !is_night) continue;
    CAPTURE(ball);
    const double samples = is_night ? 300000 : 150000;
    check_shrinking(beam_in_fog(ball), RenderMethod::bidirectional, samples, samples);
  }
}

TEST_CASE("photon map: pulse converges to light tracing as its radius shrinks") {
  const RenderScene scene{
      .field = Homogeneous{},
      .step = 1,
      .max_length = 1e3,
      .stage = {.boundary = Box{{-1, -1, 0}, {1, 1, 2}}, .medium = {.mu_s = 2, .mu_a = 0.1}},
      .lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 0.3}},
      .sensors = {AreaDetector{{0, 0, 2}, {0, 1, 0}, 1.5, 1.5, {}, pi / 2}},
      .bins = {1.9, 3.4, 16}};
  const double samples = is_night ? 600000 : 120000;
  const RenderJob light = render_job(scene, {RenderMethod::light}, 4);
  const Estimate exact = rendered_picture(light, run_render(light, samples).sums).bins;
  const auto pulse =
      [&](double radius) {  // the pulse without its first and last part, before and after the bins
        return part(estimated(photon_map_job(scene, radius, 4), samples), 1, exact.value.size());
      };
  const Estimate wide = pulse(0.1), narrow = pulse(0.05);
  for (std::size_t bin = 0; bin < exact.value.size(); ++bin) {
    CAPTURE(bin);
    const double expected = exact.value[bin].real();
    // if the offset of the optical path were ignored, the first bins would be off by 0.09
    CHECK(std::abs(wide.value[bin].real() - expected) <
          0.04 * expected + 4 * std::hypot(wide.error[bin], exact.error[bin]));
    // extrapolation that removes the blur at walls, which is proportional to the radius
    const double limit = 2 * narrow.value[bin].real() - wide.value[bin].real();
    const double error = std::hypot(2 * narrow.error[bin], wide.error[bin]);
    CHECK(std::abs(limit - expected) < 4 * std::hypot(error, exact.error[bin]));
  }
}

TEST_CASE("photon map: focused sound agrees with light tracing") {
  const RenderScene scene = beam_in_sound();
  const Rendered exact = rendered(scene, RenderMethod::light, 30000);
  const Mapped map = mapped(scene, 0.15, 60000);
  CAPTURE(exact.value());
  CAPTURE(exact.error());
  CAPTURE(map.value());
  CAPTURE(map.error());
  const double error = std::hypot(exact.error(), map.error());
  CHECK(error < 0.06 * exact.value());
  CHECK(std::abs(map.value() - exact.value()) < 4 * error);
}

TEST_CASE("photon map: converges to bidirectional tracing within a mesh") {
  if (!is_night) return;
  check_shrinking(beam_in_mesh(), RenderMethod::bidirectional, 100000, 60000);
}

}  // namespace flatspeckle::bench::test_photon_map
