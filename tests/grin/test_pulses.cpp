#include <cmath>
#include <initializer_list>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/oracles/peierls_slab.h"
#include "tests/grin/render_tests.h"

// Light resolved by optical path.

namespace flatspeckle::grin::tests::test_pulses {

using namespace oracles;

namespace {

constexpr double pi = std::numbers::pi;

/// Returns the mean optical path, which linear splatting keeps.
double mean_path(const RenderScene& scene, const RenderedPicture& picture) {
  const double width = (scene.bins.last - scene.bins.first) / scene.bins.count;
  double sum = 0, first = 0;
  for (int bin = 0; bin < scene.bins.count; ++bin) {
    const double value = picture.bins.value[bin].real();
    sum += value;
    first += value * (scene.bins.first + (bin + 0.5) * width);
  }
  return first / sum;
}

/// Returns the number of bins that are not empty.
int lit_bins(const RenderedPicture& picture) {
  int lit = 0;
  for (const Complex& value : picture.bins.value) lit += value.real() > 1e-9;
  return lit;
}

/// Checks that all light arrives in the two bins whose centres are nearest to its optical path.
void check_ballistic(RenderScene scene, double path, double tolerance) {
  scene.bins = {path - 0.5, path + 0.5, 100};
  for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
    const Rendered picture = rendered(scene, method, 500);
    const std::string how = name(method);
    CAPTURE(how);
    CHECK(picture.value() > 0);
    CHECK(lit_bins(picture.picture) <= 2);
    CHECK(std::abs(mean_path(scene, picture.picture) - path) < tolerance);
  }
}

Stage stage(const Surface& boundary, const std::optional<Body>& body = {}) {
  Stage result;
  result.boundary = boundary;
  if (body) result.bodies = {*body};
  return result;
}

Body scattering_ball(double mu_s) {
  Body ball;
  ball.surface = Sphere{};
  ball.medium.mu_s = mu_s;
  return ball;
}

AreaDetector spot(const Vec3& centre, const Vec3& up, double width) {
  return {centre, up, width, width, {}, pi / 2};
}

}  // namespace

TEST_CASE("pulse through a Luneburg ball: optical path pi/2 + 1 to the focus") {
  // The wall is slightly behind the focus.
  const double gap = 1e-6;
  check_ballistic({.field = Luneburg({}),
                   .step = 0.02,
                   .max_length = 20,
                   .stage = stage(Box{{-2, -2, -1}, {2, 2, 1 + gap}}, scattering_ball(0)),
                   .lights = {BeamLight{{0, 0, -1}, {0, 0, 1}, 0.95}},
                   .sensors = {spot({0, 0, 1 + gap}, {0, 1, 0}, 0.01)}},
                  pi / 2 + 1, 2e-5);
}

TEST_CASE("pulse in a fisheye: optical path pi n0 a / 2 to the image") {
  const double n0 = 1.6, a = 1.3;
  const Vec3 light(0, 0.4, -1.1);
  const Vec3 image = -a * a / light.squaredNorm() * light;
  check_ballistic({.field = Fisheye({n0 - 1, a}),
                   .step = 0.02,
                   .max_length = 50,
                   .stage = stage(Box{{-5, -5, -5}, {5, 5, image.z()}}),
                   .lights = {PointLight{light}},
                   .sensors = {spot(image, {0, 1, 0}, 0.01)}},
                  pi * n0 * a / 2, 2e-5);
}

TEST_CASE("pulse in a parabolic guide: optical path (n0^2 + beta^2) / (2 beta) per length") {
  const double n0 = 1.5, alpha = 0.7, angle = 0.3;
  const double beta = n0 * std::cos(angle), length = 3 * pi * beta / alpha;  // half periods
  check_ballistic({.field = ParabolicGuide({n0 - 1, alpha}),
                   .step = 0.02,
                   .max_length = 100,
                   .stage = stage(Box{{-1, -1, 0}, {1, 1, length}}),
                   .lights = {BeamLight{{0, 0, 1e-6}, {std::sin(angle), 0, std::cos(angle)}, 1e-7}},
                   .sensors = {spot({0, 0, length}, {0, 1, 0}, 0.01)}},
                  (n0 * n0 + beta * beta) / (2 * beta) * length, 2e-5);
}

TEST_CASE("time bins: sums agree with the steady picture of the same paths") {
  RenderScene scene{.field = Luneburg({}),
                    .step = 0.1,
                    .max_length = 100,
                    .stage = stage(Box{{-2, -2, -2}, {2, 2, 2}}, scattering_ball(0.7)),
                    .lights = {BeamLight{{0, 0, -2}, {0, 0, 1}, 0.7}},
                    .sensors = {DirectionalDetector{{0, 0, 1}, {0, 1, 0}, 1, {2, 2}}}};
  for (const RenderMethod method :
       {RenderMethod::path, RenderMethod::light, RenderMethod::bidirectional}) {
    scene.bins = {};
    const RenderJob steady = render_job(scene, {method}, 5);
    scene.bins = {3, 9, 30};  // the rest of the light is in the outer bins
    const RenderJob timed = render_job(scene, {method}, 5);
    // same batches, same paths
    if (steady.batches.samples_per_batch != timed.batches.samples_per_batch) continue;
    const RunState a = run_render(steady, 600), b = run_render(timed, 600);
    const Estimate whole = rendered_picture(steady, a.sums).steady;
    const Estimate sum = rendered_picture(timed, b.sums).steady;
    for (int pixel = 0; pixel < 4; ++pixel) {
      CHECK(whole.value[pixel].real() > 0);
      CHECK(sum.value[pixel].real() == doctest::Approx(whole.value[pixel].real()).epsilon(1e-9));
      CHECK(sum.error[pixel] == doctest::Approx(whole.error[pixel]).epsilon(1e-6));
    }
  }
}

TEST_CASE("late light of a slab: decay rate agrees with transport theory, nearly with diffusion") {
  const double length = 4, mu_a = 0.02;
  RenderScene scene{.field = Homogeneous{},
                    .step = 1,
                    .max_length = 1e9,
                    .stage = stage(Box{{-400, -400, 0}, {400, 400, length}}),
                    .lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 0.01}},
                    .sensors = {AreaDetector{{0, 0, length}, {0, 1, 0}, 800, 800, {}, pi / 2}},
                    .bins = {0, 80, 40}};
  scene.stage.medium.mu_s = 1;
  scene.stage.medium.mu_a = mu_a;
  const double exact = slab_decay_rate(length, 1, mu_a);
  const double diffusion = diffusion_decay_rate(length, 1, mu_a);
  const RenderJob job = render_job(scene, {RenderMethod::light}, 3);
  const RunState state = run_render(job, is_night ? 400000 : 150000);
  // two windows of bins, apart from the outer ones, which hold the rest of the light
  const int from = 10, width = 5, later = 10;
  const Estimate rate = jackknife(state.sums, [&](double, std::span<const Complex> sums) {
    double early = 0, late = 0;
    for (int bin = from; bin < from + width; ++bin) {
      early += sums[bin].real();
      late += sums[bin + later].real();
    }
    return std::vector<Complex>{std::log(early / late) / (2.0 * later)};
  });
  const double value = rate.value[0].real(), error = rate.error[0];
  CAPTURE(value);
  CAPTURE(exact);
  CHECK(error < 0.02 * exact);
  CHECK(std::abs(value - exact) < 4 * error);
  CHECK(std::abs(diffusion - exact) < 0.05 * exact);
}

}  // namespace flatspeckle::grin::tests::test_pulses
