#include <array>
#include <numeric>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/geometric_spreading.h"
#include "grin/light.h"
#include "grin/sensor.h"
#include "tests/grin/path_ends.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

Camera pinhole() {
  return {Vec3(0.4, -0.6, 1.4), Vec3(1, 0.5, -0.3), Vec3(0, 0.2, 1), 1.2, {5, 3}};
}
/// A camera whose lens is on the upper face, tilted.
Camera lens_on_box() {
  Camera camera{Vec3(0.6, -0.4, 3), Vec3(0.1, 0.05, -1), Vec3(0.3, 1, 0), 1.1, {4, 3}};
  camera.lens_radius = 0.5;
  camera.focus_distance = 2;
  return camera;
}
Camera lens_on_sphere() {
  const Vec3 outward = Vec3(-2, 1, 2) / 3;
  Camera camera{test_sphere.centre + test_sphere.radius * outward,
                -outward + Vec3(0.2, 0, 0),
                Vec3(0, 0, 1),
                1.4,
                {3, 4}};
  camera.lens_radius = 0.9;
  camera.focus_distance = 2.5;
  return camera;
}
AreaDetector area_on_box(double acceptance = pi / 2) {
  return {Vec3(0.6, -0.4, 3), Vec3(0.3, 1, 0), 1.6, 1.2, {4, 3}, acceptance};
}
AreaDetector area_on_sphere(double acceptance = pi / 2) {
  return {test_sphere.centre + test_sphere.radius * Vec3(-2, 1, 2) / 3,
          Vec3(0, 0, 1),
          1.6,
          1.2,
          {4, 3},
          acceptance};
}
DirectionalDetector directional(double half_angle) {
  return {Vec3(0.2, -0.4, 1), Vec3(0, 1, 0.3), half_angle, {4, 5}};
}

/// Sums over paths that each fall into one pixel or none.
class Picture {
 public:
  explicit Picture(const SensorEnd& sensor)
      : sum_(sensor.pixels().count()), squares_(sensor.pixels().count()) {}

  void begin_path() { ++paths_; }
  void add(int pixel, double value) {
    sum_[pixel] += value;
    squares_[pixel] += value * value;
  }
  int pixels() const { return static_cast<int>(sum_.size()); }
  double mean(int pixel) const { return sum_[pixel] / paths_; }
  double variance(int pixel) const {
    return (squares_[pixel] / paths_ - mean(pixel) * mean(pixel)) / paths_;
  }
  template <class Expected>
  void check(const Expected& expected) const {
    for (int pixel = 0; pixel < pixels(); ++pixel) {
      CAPTURE(pixel);
      CAPTURE(mean(pixel));
      CAPTURE(expected(pixel));
      CHECK(std::abs(mean(pixel) - expected(pixel)) <= 4 * std::sqrt(variance(pixel)) + 1e-12);
    }
  }
  /// Pixel by pixel, and not dark.
  void check_like(const Picture& other) const {
    CHECK(std::accumulate(sum_.begin(), sum_.end(), 0.0) > 0);
    for (int pixel = 0; pixel < pixels(); ++pixel) {
      CAPTURE(pixel);
      CAPTURE(mean(pixel));
      CAPTURE(other.mean(pixel));
      CHECK(std::abs(mean(pixel) - other.mean(pixel)) <=
            4 * std::sqrt(variance(pixel) + other.variance(pixel)));
    }
  }

 private:
  std::vector<double> sum_, squares_;
  double paths_ = 0;
};

constexpr int paths = 200000;

/// A light and a sensor in an empty stage of constant index.
struct Pair {
  Surface boundary;
  Light light;
  Sensor sensor;
  double n = 1.3;

  UniformSpace space() const { return {n}; }
  Lights lights() const {
    return {{light}, empty_stage(boundary), [this](const PathPoint&) { return n; }};
  }
  SensorEnd end() const { return {sensor, empty_stage(boundary)}; }
};

/// From the sensor to where the light is hit.
Picture seen_from_sensor(const Pair& pair, std::uint64_t seed) {
  const Lights lights = pair.lights();
  const SensorEnd sensor = pair.end();
  Picture picture(sensor);
  RandomStream random(seed, 91, 0);
  for (int i = 0; i < paths; ++i) {
    picture.begin_path();
    const EndPosition at = sensor.sample_position(pair.space(), random);
    const EndDirection to = sensor.sample_direction(at, random);
    if (to.strength == 0) continue;
    const double weight = to.strength / (at.position_density * to.density);
    lights.hit(pair.space(), exit_point(pair.boundary, at.point.x, to.direction), to.direction,
               [&](const EndHit& hit) { picture.add(to.pixel, weight * hit.value); });
  }
  return picture;
}

/// From the light to where the sensor is hit.
Picture thrown_by_light(const Pair& pair, std::uint64_t seed) {
  const Lights lights = pair.lights();
  const SensorEnd sensor = pair.end();
  Picture picture(sensor);
  RandomStream random(seed, 92, 0);
  for (int i = 0; i < paths; ++i) {
    picture.begin_path();
    const EndPosition at = lights.sample_position(pair.space(), random);
    const EndDirection to = lights.sample_direction(at, random);
    const double weight = to.strength / (at.position_density * to.density);
    sensor.hit(pair.space(), exit_point(pair.boundary, at.point.x, to.direction), to.direction,
               [&](const EndHit& hit) { picture.add(hit.direction.pixel, weight * hit.value); });
  }
  return picture;
}

/// A place on each, joined by a straight line: |J| = r^2.
Picture joined(const Pair& pair, std::uint64_t seed) {
  const Lights lights = pair.lights();
  const SensorEnd sensor = pair.end();
  Picture picture(sensor);
  RandomStream random(seed, 93, 0);
  for (int i = 0; i < paths; ++i) {
    picture.begin_path();
    const EndPosition y = lights.sample_position(pair.space(), random);
    const EndPosition z = sensor.sample_position(pair.space(), random);
    const Vec3 line = z.point.x - y.point.x, d = line.normalized();
    const EndDirection from_light = lights.towards(y, d), to_sensor = sensor.towards(z, -d);
    if (to_sensor.pixel >= 0)
      picture.add(to_sensor.pixel, from_light.strength * to_sensor.strength /
                                       (y.position_density * z.position_density) /
                                       (pair.n * pair.n * line.squaredNorm()));
  }
  return picture;
}

FaceLight environment() {
  return {Vec3::Zero(), infinity, 1};
}
FaceLight disk_light() {
  return {Vec3(0.4, -0.3, 0.5), 0.9, 2.5};
}
FaceLight cap_light() {
  return {test_sphere.centre + test_sphere.radius * Vec3(1, 0, 0), 1.5, 0.8};
}

/// By both ways that meet the environment.
template <class Expected>
void check_in_environment(const Surface& boundary, const Sensor& sensor, bool hit,
                          const Expected& expected, std::uint64_t seed) {
  const Pair pair{boundary, environment(), sensor};
  seen_from_sensor(pair, seed).check(expected);
  if (hit) thrown_by_light(pair, seed).check(expected);
}

/// Mean over a pixel of f(u, v).
template <class F>
double pixel_mean(const PixelGrid& grid, int pixel, double half_width, double half_height, F f) {
  constexpr int parts = 40;
  double sum = 0;
  for (int i = 0; i < parts; ++i)
    for (int j = 0; j < parts; ++j)
      sum += f(half_width * (2 * (pixel % grid.columns + (i + 0.5) / parts) / grid.columns - 1),
               half_height * (1 - 2 * (pixel / grid.columns + (j + 0.5) / parts) / grid.rows));
  return sum / (parts * parts);
}

std::string complaint(const Stage& stage, const Sensor& sensor) {
  try {
    const SensorEnd end(sensor, stage);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("sensors sample directions by their density") {
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
}

TEST_CASE("a directional detector up to the horizon samples by its density what it sees") {
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

TEST_CASE("sensors sample points of the boundary by their density") {
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
  lens.field_of_view = 2;  // so that light along the normals is seen all over it
  check(test_sphere, lens, 2);
  check(test_box, area_on_box(), 3);
  check(test_sphere, area_on_sphere(), 4);
}

TEST_CASE("a sensor that is hit is the sensor that is sampled") {
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
}

TEST_CASE("under a uniform environment: cameras read L/n^2, detectors pi n^2 sin^2(acceptance)") {
  const double n = 1.3;
  const auto one = [](int) { return 1.0; };
  check_in_environment(test_box, pinhole(), false, one, 1);
  check_in_environment(test_box, lens_on_box(), true, one, 2);
  check_in_environment(test_sphere, lens_on_sphere(), true, one, 3);
  for (const double acceptance : {pi / 2, 0.5}) {
    const double sine = std::sin(acceptance);
    const auto irradiance = [&](int) { return pi * n * n * sine * sine; };
    check_in_environment(test_box, area_on_box(acceptance), true, irradiance, 4);
    check_in_environment(test_sphere, area_on_sphere(acceptance), true, irradiance, 5);
    AreaDetector whole_face{Vec3(0.5, -0.5, 3), Vec3(0, 1, 0), 3, 3, {2, 3}, acceptance};
    check_in_environment(test_box, whole_face, true, irradiance, 6);
  }
}

TEST_CASE("under a uniform environment the directional detector reads n^2 times the shadow") {
  const double n = 1.3;
  for (const double half_angle : {0.6, pi / 2}) {
    const DirectionalDetector detector = directional(half_angle);
    const double side = std::sin(half_angle);
    const Vec3 forward = detector.forward.normalized();
    const Vec3 right = forward.cross(detector.up).normalized(), up = right.cross(forward);
    const auto of_sphere = [&](double u, double v) {
      return u * u + v * v < 1 ? n * n * pi * test_sphere.radius * test_sphere.radius : 0;
    };
    const auto of_box = [&](double u, double v) {
      if (u * u + v * v >= 1) return 0.0;
      const Vec3 d = u * right + v * up + std::sqrt(1 - u * u - v * v) * forward;
      const Vec3 size = test_box.high - test_box.low;
      return n * n * d.cwiseAbs().dot(size.prod() * size.cwiseInverse());
    };
    const auto mean = [&](const auto& f) {
      return [&](int pixel) { return pixel_mean(detector.pixels, pixel, side, side, f); };
    };
    check_in_environment(test_sphere, detector, true, mean(of_sphere), 6);
    check_in_environment(test_box, detector, true, mean(of_box), 7);
  }
}

TEST_CASE("form factors: a disk over a rectangle, and any two parts of a sphere") {
  const double n = 1.3, h = 2.5, a = 0.9;
  const Vec3 up = Vec3(0.3, 1, 0).normalized(), right = Vec3::UnitZ().cross(up);
  const Vec3 between = area_on_box().centre - disk_light().centre;
  // of a Lambertian disk on a parallel element at distance d from its axis
  const auto irradiance = [&](double u, double v) {
    const Vec3 r = between + u * right + v * up;
    const double squared = r.x() * r.x() + r.y() * r.y();
    const double s = squared + h * h + a * a;
    return pi * n * n * 2.5 * (1 - (s - 2 * a * a) / std::sqrt(s * s - 4 * a * a * squared)) / 2;
  };
  const auto on_box = [&](int pixel) {
    return pixel_mean(area_on_box().pixels, pixel, 0.8, 0.6, irradiance);
  };
  const Pair over{test_box, disk_light(), area_on_box()};
  seen_from_sensor(over, 1).check(on_box);
  thrown_by_light(over, 2).check(on_box);
  joined(over, 3).check(on_box);

  const auto on_sphere = [&](int) { return n * n * 0.8 * pi * 1.5 * 1.5 / (4 * 1.7 * 1.7); };
  const Pair inside{test_sphere, cap_light(), area_on_sphere()};
  seen_from_sensor(inside, 4).check(on_sphere);
  thrown_by_light(inside, 5).check(on_sphere);
  joined(inside, 6).check(on_sphere);
}

TEST_CASE("a point's light by direction is its power over 4 pi, by hits and by joins") {
  const auto expected = [](int) { return 3 / (4 * pi); };
  const Pair pair{test_box, PointLight{Vec3(0.7, -1, 1.1), 3}, directional(0.7)};
  thrown_by_light(pair, 1).check(expected);
  joined(pair, 2).check(expected);
}

TEST_CASE("a beam falls on the pixels in front of it with its power over its area") {
  AreaDetector detector = area_on_box(0.1);
  const Pair pair{test_box, BeamLight{Vec3(0.6, -0.4, 1), Vec3(0, 0, 2), 1.05, 7}, detector};
  thrown_by_light(pair, 1).check([](int) { return 7 / (pi * 1.05 * 1.05); });
}

TEST_CASE("lenses: by sensor, by light and by joins the same picture") {
  const auto check = [](const Pair& pair, std::uint64_t seed) {
    CAPTURE(seed);
    const Picture reference = joined(pair, seed);
    reference.check_like(thrown_by_light(pair, seed));
    if (!std::holds_alternative<PointLight>(pair.light))
      reference.check_like(seen_from_sensor(pair, seed));
  };
  Camera narrow = lens_on_box();
  narrow.field_of_view = 0.5;
  check({test_box, disk_light(), narrow}, 1);
  narrow.focus_distance = 0.7;
  check({test_box, FaceLight{Vec3(0, 0, 0.5), 0.99, 1}, narrow}, 2);
  Camera wide = lens_on_sphere();
  wide.field_of_view = 0.8;
  check({test_sphere, FaceLight{2 * test_sphere.centre - wide.x, 2, 1}, wide}, 3);
  wide.focus_distance = 1.2;
  wide.field_of_view = 0.4;
  check({test_sphere, PointLight{test_sphere.centre, 2}, wide}, 4);
}

TEST_CASE("rays to a point in the plane of focus are one pixel's, from anywhere on the lens") {
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

TEST_CASE("row 0 is on top and columns run along forward x up") {
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

TEST_CASE("even strata give every pixel the same number of paths") {
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

TEST_CASE("where the body reaches through the boundary, hits and positions are in the body") {
  Stage stage = empty_stage(test_box);
  stage.body = Body{Box{Vec3(-0.5, -0.5, 0), Vec3(0.5, 0.5, 4)}};
  const SensorEnd end(directional(0.5), stage);
  int inside = 0;
  RandomStream random(1, 98, 0);
  for (int i = 0; i < 1000; ++i) {
    const EndPosition at = end.sample_position(UniformSpace{}, random);
    const Vec3 x = at.point.x;
    const bool in_body = std::max(std::abs(x.x()), std::abs(x.y())) < 0.5;
    CHECK(at.point.part == (in_body ? Part::body : Part::stage));
    inside += in_body;
  }
  CHECK(inside > 10);
}

TEST_CASE("sensors that cannot be are refused by the keys of the scene") {
  const double nan = std::nan("");
  const Stage box = empty_stage(test_box), sphere = empty_stage(test_sphere);
  Stage filled = box;
  filled.body = Body{Sphere{Vec3(0.4, -0.6, 1.4), 0.2}};
  const auto refused = [](const Stage& stage, const Sensor& sensor, const std::string& words) {
    const std::string line = complaint(stage, sensor);
    CAPTURE(line);
    CAPTURE(words);
    CHECK(line.find(words) != std::string::npos);
    CHECK(line.find('\n') == std::string::npos);
  };
  const auto with = [](auto sensor, auto member, auto value) {
    sensor.*member = value;
    return sensor;
  };
  CHECK(complaint(box, pinhole()).empty());
  CHECK(complaint(box, lens_on_box()).empty());
  CHECK(complaint(box, area_on_box()).empty());
  refused(filled, pinhole(), "1.4: must not be inside the body");
  refused(box, with(pinhole(), &Camera::x, Vec3(0, 0, 0.4)), "must be inside the stage");
  CHECK(complaint(box, with(pinhole(), &Camera::x, Vec3(0, 0, 0.5))).empty());
  refused(box, with(pinhole(), &Camera::x, Vec3(0, nan, 1)), "sensor_at");
  refused(box, with(pinhole(), &Camera::forward, Vec3(0, 0, 0)), "sensor_direction = 0 0 0: ");
  refused(box, with(pinhole(), &Camera::up, Vec3(0, 0, 0)), "sensor_up");
  refused(box, with(pinhole(), &Camera::up, Vec3(-2, -1, 0.6)), "sensor_up = ");
  for (const double angle : {0.0, -1.0, pi, nan})
    refused(box, with(pinhole(), &Camera::field_of_view, angle), "field_of_view");
  for (const PixelGrid& grid : {PixelGrid{0, 3}, PixelGrid{3, -1}, PixelGrid{100000, 100000}})
    refused(box, with(pinhole(), &Camera::pixels, grid), "pixels = ");
  refused(box, with(pinhole(), &Camera::lens_radius, 0.1), "must be on the boundary");
  for (const double radius : {-1.0, nan, infinity, 5.0})
    refused(box, with(lens_on_box(), &Camera::lens_radius, radius), "lens_radius");
  for (const double distance : {0.0, -1.0, 0.4, nan, infinity})
    refused(box, with(lens_on_box(), &Camera::focus_distance, distance), "focus_distance");
  refused(box, with(lens_on_box(), &Camera::forward, Vec3(0, 0, 1)), "sensor_direction");
  refused(box, with(area_on_box(), &AreaDetector::centre, Vec3(0, 0, 2)), "sensor_at");
  refused(box, with(area_on_box(), &AreaDetector::centre, Vec3(nan, 0, 3)), "sensor_at");
  refused(box, with(area_on_box(), &AreaDetector::up, Vec3(0, 0, 1)), "sensor_up");
  for (const double width : {0.0, -1.0, 2.9, nan, infinity})
    refused(box, with(area_on_box(), &AreaDetector::width, width), "sensor_size");
  refused(sphere, with(area_on_sphere(), &AreaDetector::width, 3.3), "sensor_size");
  for (const double angle : {0.0, -1.0, 1.6, nan}) refused(box, area_on_box(angle), "acceptance");
  for (const double angle : {0.0, -1.0, 1.6, nan}) refused(box, directional(angle), "half_angle");
  refused(empty_stage(Plane{Vec3::Zero(), Vec3::UnitZ()}), directional(1),
          "needs a sphere or a box");
}

}  // namespace flatspeckle::grin
