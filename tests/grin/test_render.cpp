#include <doctest/doctest.h>

#include "core/error.h"
#include "core/run/stopwatch.h"
#include "tests/grin/furnace.h"

namespace flatspeckle::grin::tests::test_render {

namespace {

const Light point = PointLight{Vec3(0.3, -0.2, 0.5)};
const Camera camera{Vec3(0, 0.2, -0.7), Vec3::UnitZ(), Vec3::UnitY(), 1.0, {2, 2}};
const AreaDetector detector{Vec3::UnitZ(), Vec3::UnitY(), 1, 1, {2, 1}, right_angle};
const Fisheye fisheye({.centre_excess = 0.7, .radius = 2});

bool is_valid(const Rendered& result) {
  bool valid = result.counts.lost_values == 0;
  for (std::size_t i = 0; i < result.picture.steady.value.size(); ++i)
    valid = valid && std::isfinite(result.value(i)) && result.value(i) >= 0 &&
            std::isfinite(result.error(i));
  return valid;
}

}  // namespace

TEST_CASE("render: depends on the seed, not on the number of threads") {
  for (const AnyIndexField& field : {AnyIndexField(fisheye), AnyIndexField(Homogeneous{0.2})}) {
    const RenderScene scene = scene_in(field, {unit_box(), fog(1, 0.1, 0.5)}, point, camera);
    const auto sums = [&](std::uint64_t seed, int threads) {
      return run_render(render_job(scene, {}, seed), 600, threads).sums.total();
    };
    const auto one = sums(1, 1), three = sums(1, 3), other = sums(2, 3);
    CHECK(one == three);
    CHECK(one != other);
  }
}

TEST_CASE("render: sums over bins of optical path agree with the steady picture") {
  for (const AnyIndexField& field : {AnyIndexField(fisheye), AnyIndexField(Homogeneous{0.2})}) {
    RenderScene scene = scene_in(field, {unit_box(), fog(1, 0.1, 0.5)}, point, camera);
    const Rendered steady = rendered(scene, RenderMethod::bidirectional, 2000);
    scene.bins = {1, 5, 7};
    const Rendered timed = rendered(scene, RenderMethod::bidirectional, 2000);
    for (int pixel = 0; pixel < 4; ++pixel) {
      CHECK(timed.value(pixel) == doctest::Approx(steady.value(pixel)).epsilon(1e-12));
      double sum =
          timed.picture.before.value[pixel].real() + timed.picture.after.value[pixel].real();
      int filled = 0;
      for (int bin = 0; bin < 7; ++bin) {
        sum += timed.picture.bins.value[pixel * 7 + bin].real();
        filled += timed.picture.bins.value[pixel * 7 + bin].real() > 0;
      }
      CHECK(sum == doctest::Approx(steady.value(pixel)).epsilon(1e-12));
      CHECK(filled > 3);
    }
  }
}

TEST_CASE("render: reciprocal under exchange of light and sensor in a varying index") {
  // a disk and a square of the same area: a difference of 1e-3 at the most
  constexpr double radius = 0.15;
  const double side = radius * std::sqrt(std::numbers::pi);
  const Vec3 a(0.3, -0.1, 1), b(1, 0.2, -0.4);
  const AnyIndexField field = Fisheye({.centre_excess = 1, .radius = 1}, Vec3(-0.5, 0, -0.6));
  const Stage stage{unit_box(), fog(1, 0.2, 0.4)};
  const auto detector_at = [&](const Vec3& x) {
    return AreaDetector{x, Vec3::UnitY(), side, side, {1, 1}, right_angle};
  };
  for (const RenderMethod method : unbiased_methods) {
    // by day only the method whose error is 2 %: the others need ten times the paths
    if (!is_night && method != RenderMethod::bidirectional) continue;
    const double samples = is_night ? 1e4 : 4e3;
    const Rendered forth =
        rendered(scene_in(field, stage, FaceLight{a, radius, 1}, detector_at(b)), method, samples);
    const Rendered back = rendered(scene_in(field, stage, FaceLight{b, radius, 1}, detector_at(a)),
                                   method, samples, 2);
    CAPTURE(name(method));
    CAPTURE(forth.error() / forth.value());
    CHECK(std::abs(forth.value() - back.value()) <
          4 * std::hypot(forth.error(), back.error()) + 1e-3 * forth.value());
  }
}

TEST_CASE("render without absorption: all power leaves through the boundary") {
  const Stage stage{unit_box(), fog(2, 0, 0.5)};
  for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
    double power = 0, variance = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        const Vec3 centre = side * Vec3::Unit(axis), up = Vec3::Unit((axis + 1) % 3);
        const AreaDetector face{centre, up, 2, 2, {1, 1}, right_angle};
        const Rendered result = rendered(scene_in(fisheye, stage, point, face), method, 5000,
                                         static_cast<std::uint64_t>(2 * axis + (side > 0)));
        power += 4 * result.value();
        variance += 16 * result.error() * result.error();
      }
    CAPTURE(name(method));
    CHECK(std::abs(power - 1) < 4 * std::sqrt(variance));
    CHECK(variance < 0.02 * 0.02);
  }
}

TEST_CASE("render of extreme scenes: values are finite and not negative") {
  struct Extreme {
    const char* name;
    RenderScene scene;
  };
  const auto in_medium = [&](const ScatteringMedium& medium) {
    return scene_in(fisheye, {unit_box(), medium}, point, camera);
  };
  Camera at_centre = camera;
  at_centre.x = Vec3::Zero();
  const Fisheye strong({.centre_excess = 1, .radius = 0.5});
  const std::vector<Extreme> all{
      {"thin", in_medium(fog(5e-4, 0, 0))},
      {"thick", scene_in(Homogeneous{}, {unit_box(), fog(50, 0.5, 0.9)}, point, camera)},
      {"forward", in_medium(fog(2, 0, 0.99))},
      {"black", in_medium(fog(0, 2, 0))},
      {"almost black", in_medium(fog(0.02, 1.98, 0))},
      {"light on the sensor",
       scene_in(Homogeneous{}, {unit_box(), fog(1, 0, 0)}, PointLight{camera.x}, camera)},
      {"light on the sensor, curved",
       scene_in(fisheye, {unit_box(), fog(1, 0, 0)}, PointLight{camera.x}, camera)},
      {"camera at the centre",
       scene_in(strong, {unit_box(), fog(1, 0, 0)}, environment(), at_centre)},
      {"light at the image of the camera",
       scene_in(strong, {unit_box(), fog(0.1, 0, 0)}, PointLight{Vec3(0, 0, 0.5)},
                Camera{Vec3(0, 0, -0.5), Vec3::UnitZ(), Vec3::UnitY(), 1.0, {2, 2}})}};
  for (const Extreme& extreme : all) {
    CAPTURE(extreme.name);
    for (const RenderMethod method : unbiased_methods) {
      CAPTURE(name(method));
      CHECK(is_valid(rendered(extreme.scene, method, is_night ? 300 : 100)));
    }
  }
}

TEST_CASE("render plans: simplifications do not change pictures") {
  const RenderScene least = scene_in(Homogeneous{0.2}, {unit_box(), fog(1, 0, 0.5)}, point, camera);
  RenderScene more = least;
  // a body that light hardly ever meets
  more.stage.bodies.push_back({Sphere{Vec3(-0.999, -0.999, -0.999), 1e-4}, {}});
  more.stage.excess_around = 0.2;
  more.field = Homogeneous{0.2};
  CHECK(render_job(least, {}, 1).plan.find("single medium") != std::string::npos);
  CHECK(render_job(more, {}, 1).plan.find("a body") != std::string::npos);
  const Rendered a = rendered(least, RenderMethod::bidirectional, 2000);
  const Rendered b = rendered(more, RenderMethod::bidirectional, 2000);
  for (int pixel = 0; pixel < 4; ++pixel)
    CHECK(a.value(pixel) == doctest::Approx(b.value(pixel)).epsilon(1e-12));
}

TEST_CASE("render of long paths: short pilot run, batches of one sample") {
  const RenderScene scene =
      scene_in(Homogeneous{}, {unit_box(), fog(5000, 0, 0.9)}, point, whole_face());
  const double start = thread_cpu_seconds();
  const RenderJob job = render_job(scene, {RenderMethod::bidirectional}, 1);
  CHECK(thread_cpu_seconds() - start < 2);
  CHECK(job.batches.samples_per_batch == 1);
}

TEST_CASE("render of counted paths of a thousand flights: batches of many samples") {
  RenderScene scene = scene_in(Homogeneous{}, {unit_box(), fog(60, 0, 0)}, point, whole_face());
  scene.map = BoxCells({Vec3(-1, -1, -1), Vec3(1, 1, 1)}, {40, 40, 40});
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 1);
  CHECK(job.batches.samples_per_batch >= 32);
}

TEST_CASE("render: bad requests are rejected") {
  const RenderScene scene = scene_in(fisheye, {unit_box(), {}}, point, camera);
  const RenderScene dense = scene_in(Homogeneous{}, {unit_box(), fog(1e7, 0, 0.9)}, point, camera);
  CHECK_THROWS_AS(render_job(dense, {}, 1), InputError);
  const RenderRequest short_paths{.method = RenderMethod::light, .max_scatterings = 20};
  CHECK_NOTHROW(render_job(dense, short_paths, 1));
  // no flight would end, for so many tentative collisions around a small grid
  RenderScene speck = dense;
  const FieldGrid small{Vec3::Zero(), Vec3::Constant(1e-3), {2, 2, 2}};
  speck.stage.medium.density = std::make_shared<DensityGrid>(small, std::vector(8, 1.0));
  CHECK_THROWS_AS(render_job(speck, short_paths, 1), InputError);
  speck.stage.medium.mu_s = 1e4;
  CHECK_NOTHROW(render_job(speck, short_paths, 1));
  RenderScene silent = scene;
  silent.random_phase = true;
  CHECK_THROWS_AS(render_job(silent, {}, 1), InputError);
}

}  // namespace flatspeckle::grin::tests::test_render
