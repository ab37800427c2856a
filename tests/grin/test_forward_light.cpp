#include <cmath>
#include <numbers>
#include <utility>

#include <doctest/doctest.h>

#include "grin/render/methods/forward_light.h"
#include "grin/render/methods/tracer.h"
#include "grin/render/pictures/render_datasets.h"
#include "tests/grin/render_tests.h"

// Forward tracing without connections, in SIMD lanes, and powers on nested disks.

namespace flatspeckle::grin::tests::test_forward_light {

namespace {

using std::numbers::pi;

ScatteringMedium tissue(double mu_s, double mu_a) {
  ScatteringMedium medium{.mu_s = mu_s, .mu_a = mu_a};
  medium.phase = SpacePhaseFunction{HgPhase{0.7}};
  return medium;
}

/// Returns an acoustic guide in a box under a beam, with disks of these radii on the far side.
RenderScene guide(double mu_s, double mu_a, std::vector<double> radii) {
  RenderScene scene;
  scene.field = StandingWave(0.33, 0.01, 0, 3, 6);
  scene.step = 0.1;
  scene.max_length = 200;
  scene.stage = {.boundary = Box{{-3, -3, 0}, {3, 3, 6}}, .medium = tissue(mu_s, mu_a)};
  scene.lights = {BeamLight{{0, 0, 0}, Vec3::UnitZ(), 0.5}};
  scene.leapfrogs = true;
  const double last = radii.back();
  const int rings = static_cast<int>(radii.size());
  scene.sensors = {RadialDetector{{0, 0, 6}, last, rings, pi / 2, std::move(radii)}};
  return scene;
}

PowersWithin powers(const RenderScene& scene, RenderMethod method, double samples,
                    std::uint64_t seed) {
  const RenderJob job = render_job(scene, {method}, seed);
  return *render_result(scene, job, run_render(job, samples).sums)[0].within;
}

}  // namespace

TEST_CASE("aimed light: the power between coaxial disks is exact, and its error small") {
  const double radius = 0.3, distance = 4;
  RenderScene scene{};
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage.boundary = Box{{-2, -2, 0}, {2, 2, distance}};
  scene.lights = {FaceLight{Vec3::Zero(), radius, 1}};
  scene.sensors = {RadialDetector{{0, 0, distance}, radius, 1, pi / 2, {}}};
  // view factor F of disks of equal radius: 1 + (1 - sqrt(4 R^2 + 1)) / (2 R^2), R = radius /
  // distance
  const double square = radius * radius / (distance * distance);
  const double factor = 1 + (1 - std::sqrt(4 * square + 1)) / (2 * square);
  const double samples = 20000;
  const Rendered found = rendered(scene, RenderMethod::forward, samples);
  const double area = pi * radius * radius, power = area * found.value(),
               error = area * found.error();
  const double expected = pi * area * factor;
  CAPTURE(power);
  CAPTURE(error);
  CHECK(std::abs(power - expected) < 4 * error);
  const double unaimed = expected * std::sqrt((1 - factor) / (factor * samples));
  CHECK(error < 0.3 * unaimed);
}

TEST_CASE("forward tracing: powers agree with light tracing and bidirectional tracing") {
  const RenderScene scene = guide(0.3, 0.05, {0.3, 1, 2.5});
  const PowersWithin one = powers(scene, RenderMethod::forward, 60000, 1);
  for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
    CAPTURE(name(method));
    const PowersWithin other = powers(scene, method, 8000, 2);
    for (std::size_t i = 0; i < 3; ++i) {
      const double error = std::hypot(one.power.error[i], other.power.error[i]);
      CAPTURE(one.power.value[i].real());
      CHECK(std::abs(one.power.value[i] - other.power.value[i]) < 4 * error);
      CHECK(one.power.error[i] < 0.02 * one.power.value[i].real());
    }
  }
}

TEST_CASE("forward tracing in a uniform index: powers agree with light tracing") {
  RenderScene scene = guide(0.3, 0.05, {0.5, 2.5});
  scene.field = Homogeneous{0.33};
  const PowersWithin one = powers(scene, RenderMethod::forward, 60000, 1),
                     other = powers(scene, RenderMethod::light, 60000, 2);
  for (std::size_t i = 0; i < 2; ++i)
    CHECK(std::abs(one.power.value[i] - other.power.value[i]) <
          4 * std::hypot(one.power.error[i], other.power.error[i]));
}

TEST_CASE("forward tracing: terminations account for all emitted power") {
  const RenderScene scene = guide(0.3, 0.05, {2.5});
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 1);
  const RunState state = run_render(job, 4000);
  const auto terminations = state.sums.total();
  double ended = 0;
  for (std::size_t termination = 1; termination < EnergyBalance::size; ++termination)
    ended += terminations[job.pictures + termination].real();
  const double emitted = terminations[job.pictures].real();
  CHECK(emitted == doctest::Approx(state.sums.total_samples()).epsilon(1e-12));
  CHECK(ended == doctest::Approx(emitted).epsilon(1e-12));
}

namespace {

std::shared_ptr<const Space> space_of(const RenderScene& scene, Spreading spreading) {
  return make_space(scene.field, scene.stage,
                    {scene.step, scene.max_length, spreading, scene.leapfrogs});
}

/// Sums on two rings, and counts, of a batch of forward-traced paths.
struct Counted {
  std::vector<Complex> sums = std::vector<Complex>(2);
  TransportCounts counts = {};
};
Counted counted(const RenderScene& scene, Spreading spreading, bool is_targeted, int paths,
                std::uint64_t batch = 0) {
  const auto transport = transport_of(scene, {RenderMethod::forward}, RenderMethod::forward);
  const auto space = space_of(scene, spreading);
  CHECK(space->has_lanes() == (spreading == Spreading::none));
  const auto target = is_targeted ? SensorTarget::of(*transport, *space, 0.1) : std::nullopt;
  CHECK(target.has_value() == is_targeted);
  Counted found;
  Film film(2, scene.bins, found.sums);
  RandomStream random(3, 0, batch);
  forward_kernel(transport, space, target, false)(paths, random, film, found.counts, nullptr);
  return found;
}

}  // namespace

/// Measures the power within 0.4 of the radius of beams of power 1 and 3. With strata of equal
/// area, 0.16 of the rays are within, rounded down or up to a whole number.
TEST_CASE("rays of beams: stratified over the area of each beam") {
  constexpr int rays = 32, batches = 200;
  constexpr double radius = 0.5, share = 0.16;
  RenderScene scene = guide(0, 0, {0.4 * radius, radius});
  scene.field = Homogeneous{};
  scene.lights = {BeamLight{{-1, 0, 0}, Vec3::UnitZ(), radius, 1},
                  BeamLight{{1, 0, 0}, Vec3::UnitZ(), radius, 3}};
  for (const double at : {-1.0, 1.0}) {
    const double power = at + 2;
    CAPTURE(power);
    std::get<RadialDetector>(scene.sensors[0]).centre = {at, 0, 6};
    const auto transport = transport_of(scene, {RenderMethod::forward}, RenderMethod::forward);
    const BeamsKernel kernel = beams_kernel({}, transport, make_space(scene.field, scene.stage));
    double sum = 0, square = 0;
    for (std::uint64_t batch = 0; batch < batches; ++batch) {
      std::vector<Complex> sums(2);
      Film film(2, scene.bins, sums);
      TransportCounts counts;
      RandomStream random(3, 0, batch);
      kernel(rays, 1.0, random, film, counts);
      const double within = sums[0].real() * pi * share * radius * radius / rays;
      sum += within / batches;
      square += within * within / batches;
    }
    const double spread = std::sqrt(square - sum * sum), own_rays = rays * power / 4;
    const double part = std::fmod(own_rays * share, 1);
    CHECK(std::abs(sum - share * power) < 4 * spread / std::sqrt(batches));
    CHECK(spread == doctest::Approx(power * std::sqrt(part * (1 - part)) / own_rays).epsilon(0.15));
  }
}

/// Each path has random numbers of its own, so that it is the same in both runs.
TEST_CASE("forward tracing in lanes: sums and flights agree with paths one by one") {
  for (const bool is_targeted : {false, true}) {
    CAPTURE(is_targeted);
    const RenderScene scene = guide(0.5, 0.02, {0.2, 0.5});
    const Counted together = counted(scene, Spreading::none, is_targeted, 2000),
                  alone = counted(scene, Spreading::all, is_targeted, 2000);
    CHECK(together.counts.flights == alone.counts.flights);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(together.sums[i].real() > 0);
      // weights depend on the positions of collisions
      CHECK(together.sums[i].real() ==
            doctest::Approx(alone.sums[i].real()).epsilon(is_targeted ? 1e-5 : 1e-9));
    }
  }
}

TEST_CASE("forward tracing split towards small sensors: powers agree with light tracing") {
  const RenderScene scene = guide(0.5, 0.05, {0.1, 0.3});
  const PowersWithin one = powers(scene, RenderMethod::forward, 60000, 1),
                     other = powers(scene, RenderMethod::light, 30000, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const double error = std::hypot(one.power.error[i], other.power.error[i]);
    CAPTURE(one.power.value[i].real());
    CAPTURE(error);
    CHECK(std::abs(one.power.value[i] - other.power.value[i]) < 4 * error);
    CHECK(error < 0.03 * one.power.value[i].real());
  }
}

TEST_CASE("forward tracing split towards small sensors: less variance for as many flights") {
  const RenderScene scene = guide(0.5, 0.05, {0.1, 0.3});
  const auto variance_of_flight = [&](bool is_targeted) {
    constexpr std::uint64_t batches = 200;
    double sum = 0, square = 0, flights = 0;
    for (std::uint64_t batch = 0; batch < batches; ++batch) {
      const Counted one = counted(scene, Spreading::none, is_targeted, 128, batch);
      const double light = one.sums[0].real();
      sum += light / batches;
      square += light * light / batches;
      flights += static_cast<double>(one.counts.flights);
    }
    return (square - sum * sum) * flights;
  };
  const double split = variance_of_flight(true), whole = variance_of_flight(false);
  CAPTURE(split / whole);
  CHECK(split < 0.7 * whole);
}

TEST_CASE("forward tracing split towards small sensors: means agree with unsplit tracing") {
  const RenderScene scene = guide(0.5, 0.05, {0.3, 0.5});
  /// Returns the mean and its error, from many batches.
  const auto mean_of = [&](bool is_targeted) {
    constexpr std::uint64_t batches = 100;
    double sum = 0, square = 0;
    for (std::uint64_t batch = 0; batch < batches; ++batch) {
      const Counted one =
          counted(scene, Spreading::none, is_targeted, is_night ? 2000 : 700, batch);
      const double light = one.sums[0].real() + one.sums[1].real();
      sum += light / batches;
      square += light * light / batches;
    }
    return std::pair(sum, std::sqrt((square - sum * sum) / (batches - 1)));
  };
  const auto [split, error_split] = mean_of(true);
  const auto [whole, error_whole] = mean_of(false);
  const double error = std::hypot(error_split, error_whole);
  CHECK(error < (is_night ? 0.02 : 0.035) * whole);
  CHECK(std::abs(split - whole) < 4 * error);
}

TEST_CASE("sensor targets: only small disks in scattering media are targets") {
  const auto has_target = [](const RenderScene& scene) {
    const auto transport = transport_of(scene, {RenderMethod::forward}, RenderMethod::forward);
    return SensorTarget::of(*transport, *space_of(scene, Spreading::none), 0.1).has_value();
  };
  CHECK(has_target(guide(0.5, 0, {0.3})));
  CHECK_FALSE(has_target(guide(0.5, 0, {2.5})));
  CHECK_FALSE(has_target(guide(0, 0.5, {0.3})));
}

TEST_CASE("powers on nested disks: covariance agrees with Bernoulli trials") {
  const RenderScene scene = guide(0.3, 0, {0.3, 0.6, 2});
  const PowersWithin all = powers(scene, RenderMethod::forward, 40000, 5);
  const auto covariance = [&](std::size_t i, std::size_t j) { return all.covariance[3 * i + j]; };
  for (std::size_t i = 0; i < 3; ++i) {
    const double error = all.power.error[i];
    CHECK(covariance(i, i) == doctest::Approx(error * error).epsilon(1e-12));
    for (std::size_t j = 0; j < 3; ++j)
      CHECK(covariance(i, j) == doctest::Approx(covariance(j, i)).epsilon(1e-12));
  }
  // each path of scattered light is a Bernoulli trial: cov = p_i (1 - p_j) / paths, p_i <= p_j
  RenderScene dark = scene;
  dark.lights = {PointLight{Vec3(0, 0, 3)}};
  dark.field = StandingWave(0.33, 1e-9, 0, 3, 6);
  const PowersWithin lit = powers(dark, RenderMethod::forward, 200000, 6);
  const auto p = [&](std::size_t i) { return lit.power.value[i].real(); };
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j)
      CHECK(lit.covariance[3 * i + j] == doctest::Approx(p(i) * (1 - p(j)) / 200000).epsilon(0.35));
  // The largest disk has the power of the picture.
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 5);
  const RenderResult result = render_result(scene, job, run_render(job, 40000).sums);
  CHECK(result[0].total->value[0].real() ==
        doctest::Approx(all.power.value[2].real()).epsilon(1e-12));
}

TEST_CASE("target error with radii: the largest error of the powers within") {
  const RenderScene scene = guide(0.3, 0, {0.3, 0.6, 2});
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 5);
  const RunState state = run_render(job, 20000);
  const PowersWithin all = *render_result(scene, job, state.sums)[0].within;
  CHECK(job.batches.relative_error(state.sums) ==
        doctest::Approx(largest_error(all)).epsilon(1e-12));
}

TEST_CASE("forward tracing: cameras are rejected") {
  RenderScene scene = guide(0.3, 0, {1});
  scene.sensors = {Camera{{0, 0, 5}, -Vec3::UnitZ(), Vec3::UnitY(), 1, {4, 4}}};
  CHECK_THROWS_AS(check(scene, {RenderMethod::forward}), InputError);
}

}  // namespace flatspeckle::grin::tests::test_forward_light
