#include <array>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "tests/grin/example_sensors.h"

namespace flatspeckle::grin::test_sensor {

namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string error_message(const Stage& stage, const Sensor& sensor) {
  try {
    const SensorEnd end(sensor, stage);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("sensors: sampled directions agree with their density") {
  const auto check = [](const Surface& boundary, const Sensor& sensor, const Vec3& axis,
                        std::uint64_t seed) {
    CAPTURE(seed);
    const SensorEnd end(sensor, empty_stage(boundary));
    RandomStream random(seed, 94, 0);
    const EndPosition at = end.sample_position(TiltedSpace{}, random);
    check_directions([&](RandomStream& r) { return end.sample_direction(at, r); },
                     [&](const Vec3& d) { return end.towards(at, d); }, axis.normalized(), seed);
  };
  const Vec3 askew(0.3, 1, 0.2);
  check(test_box, pinhole(), pinhole().forward, 1);
  check(test_box, pinhole(), askew, 2);
  check(test_box, lens_on_box(), askew, 3);
  check(test_sphere, lens_on_sphere(), lens_on_sphere().forward, 4);
  check(test_box, area_on_box(), Vec3(0, 0, -1), 5);
  check(test_box, area_on_box(0.6), askew, 6);
  check(test_sphere, area_on_sphere(), askew, 7);
  check(test_box, directional(0.7), askew, 8);
  check(test_box, radial_on_box(0.6), askew, 9);
  check(test_sphere, radial_on_sphere(), askew, 10);
  check(test_box, polar(0.7), askew, 11);
  check(test_sphere, polar(pi), polar(pi).axis, 12);
}

TEST_CASE(
    "directional detector up to the horizon: detected fraction of samples agrees with the "
    "density") {
  const SensorEnd end(directional(pi / 2), empty_stage(test_sphere));
  const Vec3 inward = -Vec3(0.2, -0.4, 1).normalized();
  const EndPosition at{{test_sphere.centre - test_sphere.radius * inward}, inward};
  double seen = 0, integral = 0;
  RandomStream random(1, 95, 0);
  for (int i = 0; i < 100000; ++i) {
    seen += end.sample_direction(at, random).pixel >= 0;
    const Vec3 d = direction_about(inward, 2 * random.uniform() - 1, 2 * pi * random.uniform());
    integral += end.towards(at, d).density * 4 * pi;
  }
  CHECK(seen / 1e5 == doctest::Approx(pi / 4).epsilon(0.01));
  CHECK(integral / 1e5 == doctest::Approx(pi / 4).epsilon(0.02));
}

TEST_CASE("sensors: sampled positions agree with their density") {
  const auto check = [](const Surface& boundary, const Sensor& sensor, std::uint64_t seed) {
    CAPTURE(seed);
    const SensorEnd end(sensor, empty_stage(boundary));
    const BoundaryPatch all(boundary, "boundary");
    RandomStream random(seed, 99, 0);
    // moments of the place, sampled and as integrals of the density over the boundary
    const auto moments = [](const Vec3& x) {
      return std::array{1.0, x.x(), x.y(), x.z(), x.x() * x.y(), x.y() * x.z(), x.x() * x.x()};
    };
    std::array<Average, 7> difference;
    bool on_boundary = true;
    for (int i = 0; i < 100000; ++i) {
      const Vec3 x = end.sample_position(UniformSpace{}, random).point.x;
      on_boundary = on_boundary && std::abs(distance(boundary, x)) < 1e-12;
      const BoundaryPoint at = all.sample(random);
      double density = 0;
      end.hit(UniformSpace{}, at.x, -at.inward,
              [&](const EndHit& hit) { density = hit.position.position_density; });
      for (std::size_t k = 0; k < difference.size(); ++k)
        difference[k].add(moments(x)[k] - all.area() * density * moments(at.x)[k]);
    }
    CHECK(on_boundary);
    for (const Average& d : difference) d.check(0);
  };
  Camera lens = lens_on_box();
  lens.forward = -Vec3::UnitZ();
  check(test_box, lens, 1);
  lens = lens_on_sphere();
  lens.field_of_view = 2;  // so that light along the normals is detected on all of it
  check(test_sphere, lens, 2);
  check(test_box, area_on_box(), 3);
  check(test_sphere, area_on_sphere(), 4);
  check(test_box, radial_on_box(), 5);
  check(test_sphere, radial_on_sphere(), 6);
}

TEST_CASE("sensors: hits agree with samples") {
  const auto check = [](const Surface& boundary, const Sensor& sensor, std::uint64_t seed) {
    CAPTURE(seed);
    check_hits(SensorEnd(sensor, empty_stage(boundary)), TiltedSpace{}, seed);
  };
  check(test_box, lens_on_box(), 1);
  check(test_sphere, lens_on_sphere(), 2);
  check(test_box, area_on_box(), 3);
  check(test_box, area_on_box(0.4), 4);
  check(test_sphere, area_on_sphere(), 5);
  check(test_box, directional(0.7), 6);
  check(test_sphere, directional(0.5), 7);
  check(test_box, radial_on_box(0.4), 8);
  check(test_sphere, radial_on_sphere(), 9);
  check(test_box, polar(0.7), 10);
  check(test_sphere, polar(1.4), 11);
}

TEST_CASE(
    "lens camera: rays to a point in the plane of focus share a pixel, from all of the lens") {
  const Camera camera = lens_on_sphere();
  const SensorEnd end(camera, empty_stage(test_sphere));
  const Vec3 forward = camera.forward.normalized();
  const Vec3 right = forward.cross(camera.up).normalized(), up = right.cross(forward);
  RandomStream random(1, 96, 0);
  for (int i = 0; i < 1000; ++i) {
    // three columns over tan(0.7) = 0.84 to each side, four rows over a third more
    const double u = 1.6 * random.uniform() - 0.8, v = 2.2 * random.uniform() - 1.1;
    const auto column = static_cast<int>(std::floor((u / std::tan(0.7) + 1) * 1.5));
    const auto row = static_cast<int>(std::floor((1 - v / (std::tan(0.7) * 4 / 3)) * 2));
    const Vec3 focus = camera.x + 2.5 * (forward + u * right + v * up);
    const EndPosition at = end.sample_position(UniformSpace{}, random);
    const Vec3 d = (focus - at.point.x).normalized();
    CHECK(end.towards(at, d).pixel == (d.dot(at.inward) > 0 ? row * 3 + column : -1));
  }
}

TEST_CASE("pixels: row 0 is on top, columns run along forward x up") {
  const SensorEnd camera(Camera{Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 1, 0), 1.5, {3, 3}},
                         empty_stage(test_box));
  const EndPosition eye{{Vec3(0, 0, 1)}, Vec3::Zero(), 1, 1, 0, -1, true};
  // forward x up = z x y = -x
  CHECK(camera.towards(eye, Vec3(0, 0.6, 1).normalized()).pixel == 1);
  CHECK(camera.towards(eye, Vec3(-0.6, 0, 1).normalized()).pixel == 5);
  CHECK(camera.towards(eye, Vec3(0.6, -0.6, 1).normalized()).pixel == 6);
  CHECK(camera.towards(eye, Vec3(0, 1.5, 1).normalized()).pixel == -1);
  CHECK(camera.towards(eye, Vec3(0, 0, -1)).pixel == -1);

  const auto pixel_hit = [](const Sensor& sensor, const Vec3& x, const Vec3& d) {
    int pixel = -1;
    SensorEnd(sensor, empty_stage(test_box))
        .hit(UniformSpace{}, x, d.normalized(),
             [&](const EndHit& h) { pixel = h.direction.pixel; });
    return pixel;
  };
  const AreaDetector area{Vec3(0, 0, 3), Vec3(0, 1, 0), 0.9, 0.9, {3, 3}, pi / 2};
  CHECK(pixel_hit(area, Vec3(0, 0.4, 3), Vec3(0, 0, 1)) == 1);
  CHECK(pixel_hit(area, Vec3(-0.4, 0, 3), Vec3(1, 0, 1)) == 5);
  CHECK(pixel_hit(area, Vec3(-0.5, 0, 3), Vec3(0, 0, 1)) == -1);
  CHECK(pixel_hit(area, Vec3(0, 0, 0.5), Vec3(0, 0, -1)) == -1);
  const DirectionalDetector by_direction{Vec3(0, 0, 1), Vec3(0, 1, 0), 0.8, {3, 3}};
  CHECK(pixel_hit(by_direction, Vec3(1, 0, 3), Vec3(0, 0.6, 1)) == 1);
  CHECK(pixel_hit(by_direction, Vec3(1, 0, 3), Vec3(-0.6, 0, 1)) == 5);
  CHECK(pixel_hit(by_direction, Vec3(2, 0, 1), Vec3(0.3, 0, 0.6)) == 3);
  CHECK(pixel_hit(by_direction, Vec3(1, 0, 0.5), Vec3(0, 0, -1)) == -1);
}

TEST_CASE("pixels: even strata give each the same number of paths") {
  const auto counts = [](const Surface& boundary, const Sensor& sensor) {
    const SensorEnd end(sensor, empty_stage(boundary));
    const int pixels = end.pixels().count(), samples = 7 * pixels;
    std::vector<int> result(pixels);
    RandomStream random(1, 97, 0);
    for (int i = 0; i < samples; ++i) {
      const double stratum = (i + random.uniform()) / samples;
      const EndPosition at = end.sample_position(UniformSpace{}, random, stratum);
      ++result[end.sample_direction(at, random, stratum).pixel];
    }
    return result;
  };
  for (const int count : counts(test_box, pinhole())) CHECK(count == 7);
  for (const int count : counts(test_box, area_on_box())) CHECK(count == 7);
  for (const int count : counts(test_sphere, area_on_sphere())) CHECK(count == 7);
}

TEST_CASE("sensors: positions where a body crosses the boundary are in the body") {
  Stage stage = empty_stage(test_box);
  stage.bodies.push_back({Box{Vec3(-0.5, -0.5, 0), Vec3(0.5, 0.5, 4)}});
  const SensorEnd end(directional(0.5), stage);
  int inside = 0;
  RandomStream random(1, 98, 0);
  for (int i = 0; i < 1000; ++i) {
    const EndPosition at = end.sample_position(UniformSpace{}, random);
    const Vec3 x = at.point.x;
    const bool in_body = std::max(std::abs(x.x()), std::abs(x.y())) < 0.5;
    CHECK(at.point.part == (in_body ? Part{1} : around));
    inside += in_body;
  }
  CHECK(inside > 10);
}

TEST_CASE("sensors: invalid ones are rejected by the keys of the scene") {
  const double nan = std::nan("");
  const Stage box = empty_stage(test_box), sphere = empty_stage(test_sphere);
  Stage filled = box;
  filled.bodies.push_back({Sphere{Vec3(0.4, -0.6, 1.4), 0.2}});
  const auto refused = [](const Stage& stage, const Sensor& sensor, const std::string& words) {
    const std::string line = error_message(stage, sensor);
    CAPTURE(line);
    CAPTURE(words);
    CHECK(line.find(words) != std::string::npos);
    CHECK(line.find('\n') == std::string::npos);
  };
  const auto with = [](auto sensor, auto member, auto value) {
    sensor.*member = value;
    return sensor;
  };
  CHECK(error_message(box, pinhole()).empty());
  CHECK(error_message(box, lens_on_box()).empty());
  CHECK(error_message(box, area_on_box()).empty());
  CHECK(error_message(filled, pinhole()).empty());
  refused(box, with(pinhole(), &Camera::x, Vec3(0, 0, 0.4)), "must be inside the stage");
  CHECK(error_message(box, with(pinhole(), &Camera::x, Vec3(0, 0, 0.5))).empty());
  refused(box, with(pinhole(), &Camera::x, Vec3(0, nan, 1)), "sensor_at");
  refused(box, with(pinhole(), &Camera::forward, Vec3(0, 0, 0)), "sensor_direction = 0 0 0: ");
  refused(box, with(pinhole(), &Camera::up, Vec3(0, 0, 0)), "sensor_up");
  refused(box, with(pinhole(), &Camera::up, Vec3(-2, -1, 0.6)), "sensor_up = ");
  refused(box, with(pinhole(), &Camera::lens_radius, 0.1), "must be on the boundary");
  for (const double radius : {-1.0, nan, infinity, 5.0})
    refused(box, with(lens_on_box(), &Camera::lens_radius, radius), "lens_radius");
  for (const double distance : {0.0, -1.0, 0.4, nan, infinity})
    refused(box, with(lens_on_box(), &Camera::focus_distance, distance), "focus_distance");
  refused(box, with(lens_on_box(), &Camera::forward, Vec3(0, 0, 1)), "sensor_direction");
  refused(box, with(area_on_box(), &AreaDetector::centre, Vec3(0, 0, 2)), "sensor_at");
  refused(box, with(area_on_box(), &AreaDetector::centre, Vec3(nan, 0, 3)), "sensor_at");
  refused(box, with(area_on_box(), &AreaDetector::up, Vec3(0, 0, 1)), "sensor_up");
  for (const double width : {2.9, infinity})
    refused(box, with(area_on_box(), &AreaDetector::width, width), "sensor_size");
  refused(sphere, with(area_on_sphere(), &AreaDetector::width, 3.3), "sensor_size");
  refused(empty_stage(Plane{Vec3::Zero(), Vec3::UnitZ()}), directional(1),
          "requires a sphere or a box");
}

}  // namespace flatspeckle::grin::test_sensor
