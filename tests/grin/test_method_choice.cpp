#include <doctest/doctest.h>

#include "bench/scenes/render_scenes.h"
#include "grin/render/methods/method_choice.h"
#include "tests/grin/furnace.h"
#include "tests/grin/render_tests.h"

namespace flatspeckle::grin::tests::test_method_choice {

using bench::NamedRender;

namespace {

/// Returns a box with a light and a sensor on its two ends.
RenderScene box(double mu_s, const AnyIndexField& field, const Light& light, const Sensor& sensor) {
  return {.field = field,
          .step = 0.2,
          .max_length = 1e3,
          .stage = {.boundary = Box{{-1, -1, 0}, {1, 1, 8}}, .medium = {.mu_s = mu_s}},
          .lights = {light},
          .sensors = {sensor}};
}

const Light beam = BeamLight{{0, 0, 0}, Vec3::UnitZ(), 0.3};
const Light lamp = FaceLight{Vec3(0, 0, 0), 0.2, 1};
const Sensor far_side = AreaDetector{{0, 0, 8}, Vec3::UnitY(), 2, 2, {}, std::numbers::pi / 2};
const Sensor far_pixels = AreaDetector{{0, 0, 8}, Vec3::UnitY(), 2, 2, {24, 24}, 0.5};
const Sensor pinhole = Camera{{0.9, 0, 7}, -Vec3::UnitX(), Vec3::UnitY(), 1.0, {4, 4}};

RenderMethod chosen(const RenderScene& scene) {
  return best_tracer(Tracers(scene, {})).method;
}

/// Returns a scene like the shipped slab.
RenderScene tissue() {
  RenderScene scene =
      box(10, Homogeneous{}, BeamLight{{0, 0, 0}, Vec3::UnitZ(), 1},
          AreaDetector{{0, 0, 10}, Vec3::UnitY(), 100, 100, {}, std::numbers::pi / 2});
  scene.stage.boundary = Box{{-50, -50, 0}, {50, 50, 10}};
  scene.stage.medium.phase = {HgPhase{0.9}};
  return scene;
}

/// Returns a slab of 100 mean free paths with detectors of transmitted and reflected light.
RenderScene deep_slab() {
  RenderScene scene = tissue();
  const auto face = [](double z) {
    return AreaDetector{{0, 0, z}, Vec3::UnitY(), 1e4, 1e4, {}, std::numbers::pi / 2};
  };
  scene.stage.boundary = Box{{-5000, -5000, 0}, {5000, 5000, 100}};
  scene.stage.medium.mu_s = 1;
  scene.sensors = {face(100), face(0)};
  return scene;
}

/// Returns the variance of all pixels relative to the square of the light, times the number of
/// flights and connections, whose costs differ by less than a factor of two.
double cost(const RenderScene& scene, RenderMethod method) {
  const double samples = (is_night ? 1 : 0.4) * (scene.stage.medium.mu_s > 1 ? 5000 : 30000);
  const RenderJob job = render_job(scene, {method}, 3);
  const RunState state = run_render(job, samples, 1);
  const Estimate picture = rendered_picture(job, state.sums).steady;
  double variance = 0, light = 0;
  for (const double error : picture.error) variance += error * error;
  for (const Complex pixel : picture.value) light += pixel.real();
  const TransportCounts counts = transport_counts(job, state.sums);
  return variance / (light * light) * static_cast<double>(counts.flights + counts.connections_made);
}

}  // namespace

TEST_CASE("method choice: cost within a factor of 2 of the other methods, from a longer run") {
  const ParabolicGuide guide({.axis_excess = 0.6, .alpha = 0.5});
  const NamedRender rows[] = {{"tissue", tissue()},
                              {"fog, lamp", box(0.5, Homogeneous{}, lamp, far_pixels)},
                              {"guide without scattering", box(0, guide, lamp, far_pixels)},
                              {"fog, pinhole", box(0.3, Homogeneous{}, beam, pinhole)}};
  for (const auto& row : rows) {
    CAPTURE(row.name);
    const RenderMethod best = chosen(row.scene);
    CAPTURE(method_word(best));
    for (const RenderMethod other :
         {RenderMethod::path, RenderMethod::light, RenderMethod::bidirectional}) {
      CAPTURE(method_word(other));
      if (other == best || !has_finite_variance(row.scene, other)) continue;
      CHECK(cost(row.scene, best) < 2 * cost(row.scene, other));
    }
  }
  // light paths that hit wide detectors, with control variates, gain nothing from connections
  CHECK(chosen(rows[0].scene) == RenderMethod::forward);
  CHECK(chosen(deep_slab()) == RenderMethod::forward);
}

TEST_CASE("method choice: methods of infinite variance are not chosen, and plans report it") {
  const RenderScene scene = box(0.3, Homogeneous{}, PointLight{{0, 0, 1}}, pinhole);
  CHECK(!has_finite_variance(scene, RenderMethod::path));
  CHECK(!has_finite_variance(scene, RenderMethod::light));
  CHECK(has_finite_variance(scene, RenderMethod::bidirectional));
  CHECK(has_finite_variance(box(0, Homogeneous{}, beam, pinhole), RenderMethod::light));
  CHECK(has_finite_variance(box(0.3, Homogeneous{}, lamp, far_side), RenderMethod::path));
  const auto plan = [&](const RenderRequest& request) {
    return render_job(scene, request, 1).plan;
  };
  CHECK(plan({RenderMethod::path}).find("no finite variance") != std::string::npos);
  CHECK(plan({RenderMethod::bidirectional}).find("no finite variance") == std::string::npos);
  CHECK(plan({}).starts_with("bidirectional (chosen by a pilot)"));
}

TEST_CASE("finite variance: decided by the distance of pinholes and lights to scattering media") {
  RenderScene scene = box(0, Homogeneous{}, PointLight{{0, 0, 1}}, pinhole);
  scene.stage.bodies.push_back({Sphere{{0, 0, 4}, 0.9}, {.mu_s = 1}, 0});
  CHECK(has_finite_variance(scene, RenderMethod::light));
  CHECK(has_finite_variance(scene, RenderMethod::path));
  scene.lights = {FibreLight{{0, 0, 3.2}, Vec3::UnitZ(), 0.2, 0.2}};
  CHECK(!has_finite_variance(scene, RenderMethod::path));
  scene.sensors = {Camera{{0, 0, 3.1}, Vec3::UnitZ(), Vec3::UnitY(), 1.0, {4, 4}}};
  CHECK(!has_finite_variance(scene, RenderMethod::light));
  scene.sensors = {pinhole};
  scene.stage.bodies.front().medium.mu_s = 0;
  scene.stage.medium.mu_s = 1;
  CHECK(!has_finite_variance(scene, RenderMethod::light));
  scene.sensors = {Camera{{0, 0, 4.5}, Vec3::UnitZ(), Vec3::UnitY(), 1.0, {4, 4}}};
  CHECK(has_finite_variance(scene, RenderMethod::light));
}

TEST_CASE("method choice: counted paths beside surfaces") {
  RenderScene scene =
      box(0, Homogeneous{}, beam, PolarDetector{-Vec3::UnitZ(), std::numbers::pi / 2, 24});
  scene.stage.bodies.push_back({Box{{-1, -1, 1}, {1, 1, 8}}, {10, 0.1, {HgPhase{0.9}}}, 0.4});
  CHECK(chosen(scene) == RenderMethod::forward);
}

/// No connection has a 1/r^2: the error falls as the root of the number of samples, to the right
/// value.
TEST_CASE(
    "path tracing of beams along straight rays: finite variance, agrees with bidirectional "
    "tracing") {
  const auto in_body = [&](double excess) {
    RenderScene scene = box(0.3, Homogeneous{}, beam, pinhole);
    scene.stage.bodies.push_back({Sphere{{0, 0, 4}, 0.8}, {.mu_s = 1}, excess});
    std::get<Camera>(scene.sensors[0]).pixels = {1, 1};
    return scene;
  };
  const auto is_finite = [](const RenderScene& scene) {
    return has_finite_variance(scene, RenderMethod::path);
  };
  CHECK(!is_finite(in_body(0.2)));
  CHECK(!is_finite(box(0.3, ParabolicGuide({.axis_excess = 0.6, .alpha = 0.5}), beam, pinhole)));
  const RenderScene even = in_body(0);
  CHECK(is_finite(even));
  const auto found = [&](RenderMethod method, double samples) {
    const RenderJob job = render_job(even, {method}, 3);
    return rendered_picture(job, run_render(job, samples, 1).sums).steady;
  };
  const Estimate few = found(RenderMethod::path, 10'000), many = found(RenderMethod::path, 160'000);
  const Estimate other = found(RenderMethod::bidirectional, 160'000);
  CHECK(few.error[0] / many.error[0] == doctest::Approx(4).epsilon(0.25));
  CHECK(many.error[0] < 0.02 * many.value[0].real());
  CHECK(std::abs(many.value[0] - other.value[0]) < 4 * std::hypot(many.error[0], other.error[0]));
}

namespace {

/// Returns the shipped fibre lit by another spot. Its rays refocus repeatedly, so that connections
/// contribute much more than straight lines would.
RenderScene fibre(double spot) {
  RenderScene scene =
      box(0, ParabolicGuide({.axis_excess = 0.6, .alpha = 0.5}), FaceLight{Vec3(0, 0, 0), spot, 1},
          AreaDetector{{0, 0, 50.265}, Vec3::UnitY(), 1.8, 1.8, {48, 48}, 0.5});
  scene.stage.boundary = Box{{-0.9, -0.9, 0}, {0.9, 0.9, 50.265}};
  scene.step = 0.59;
  return scene;
}

}  // namespace

TEST_CASE("connections in a fibre: made by their own contribution, not that of the straight line") {
  for (const double spot : {0.08, 0.1, 0.4}) {
    if (!is_night && spot != 0.1) continue;
    CAPTURE(spot);
    const RenderScene scene = fibre(spot);
    for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
      CAPTURE(method_word(method));
      const RenderJob job = render_job(scene, {method}, 3);
      const RunState state = run_render(job, 2000, 1);
      CHECK(static_cast<double>(transport_counts(job, state.sums).connections_made) > 200);
    }
  }
}

/// Light tracing and bidirectional tracing have the same cost in the fibre (variance times seconds
/// 0.017 and 0.019 with the shipped spot), path tracing twenty times as much.
TEST_CASE("method choice in a fibre: path tracing is not chosen for lack of high-weight paths") {
  for (const double spot : {0.08, 0.1, 0.4}) {
    if (!is_night && spot > 0.08) continue;
    CAPTURE(spot);
    CHECK(chosen(fibre(spot)) != RenderMethod::path);
  }
}

/// In this shipped scene single high-weight paths cause most of the variance of light tracing,
/// which needs five times the work. A short pilot run without them rates it best.
TEST_CASE("method choice: the pilot run goes on while another method may be much cheaper") {
  RenderScene scene = box(0.01, Homogeneous{}, BeamLight{{0, 0, -20}, Vec3::UnitZ(), 4}, pinhole);
  scene.stage.boundary = Box{{-20, -20, -20}, {20, 20, 20}};
  scene.stage.medium.phase = {HgPhase{0.5}};
  scene.stage.bodies.push_back({Sphere{{0, 0, -4}, 5}, {}, 0.5});
  for (const int width : {18, 30}) {
    if (!is_night && width > 18) continue;
    CAPTURE(width);
    Camera camera{{-20, 0, 0}, Vec3::UnitX(), Vec3::UnitY(), 1.2, {width, width * 2 / 3}};
    camera.lens_radius = 0.5;
    camera.focus_distance = 20;
    scene.sensors = {camera};
    CHECK(chosen(scene) == RenderMethod::bidirectional);
  }
}

TEST_CASE("method choice without detected light: bidirectional tracing") {
  const Light aside = BeamLight{{0, 0, 1}, Vec3::UnitX(), 0.01};
  CHECK(chosen(box(0, Homogeneous{}, aside, pinhole)) == RenderMethod::bidirectional);
}

}  // namespace flatspeckle::grin::tests::test_method_choice
