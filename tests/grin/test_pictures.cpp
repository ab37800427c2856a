#include <memory>
#include <numeric>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "grin/render/flights/space.h"
#include "grin/render/lights/light.h"
#include "tests/grin/example_sensors.h"

namespace flatspeckle::grin::test_pictures {

namespace {

using std::numbers::pi;

/// Means over paths, each of which contributes to one pixel or none.
class PixelMeans {
 public:
  explicit PixelMeans(const SensorEnd& sensor)
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
      // the variance of hits grows with their number, and is too small where the mean is
      const double share = mean(pixel) > 0 ? std::max(1.0, expected(pixel) / mean(pixel)) : 1;
      CHECK(std::abs(mean(pixel) - expected(pixel)) <=
            4 * std::sqrt(share * variance(pixel)) + 1e-12);
    }
  }
  /// Checks that all pixels agree and are not all dark.
  void check_like(const PixelMeans& other) const {
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

/// A light and a sensor in an empty stage, of constant index or with a field.
struct Pair {
  Surface boundary;
  Light light;
  Sensor sensor;
  double n = 1.3;
  std::shared_ptr<const Space> field = {};

  double index(const PathPoint& p) const { return field ? field->index(p) : n; }
  /// Returns the position and direction at which light leaves the stage.
  std::pair<Vec3, Vec3> leave(const PathPoint& from, const Vec3& d, RandomStream& random) const {
    if (!field) return {exit_point(boundary, from.x, d), d};
    const Flight flight = field->fly(from, d, random);
    CHECK(flight.end == Flight::End::boundary);
    return {flight.point.x, flight.direction};
  }
  StageLights lights() const {
    return {{light}, empty_stage(boundary), [this](const PathPoint& p) { return index(p); }};
  }
  SensorEnd end() const { return {sensor, empty_stage(boundary)}; }
};

/// Traces paths from the sensor that hit the light.
PixelMeans traced_from_sensor(const Pair& pair, std::uint64_t seed) {
  const StageLights lights = pair.lights();
  const SensorEnd sensor = pair.end();
  PixelMeans picture(sensor);
  RandomStream random(seed, 91, 0);
  for (int i = 0; i < paths; ++i) {
    picture.begin_path();
    const EndPosition at = sensor.sample_position(pair, random);
    const EndDirection to = sensor.sample_direction(at, random);
    if (to.strength == 0) continue;
    const double weight = to.strength / (at.position_density * to.density);
    const auto [x, d] = pair.leave(at.point, to.direction, random);
    lights.hit(pair, x, d, [&](const EndHit& hit) { picture.add(to.pixel, weight * hit.value); });
  }
  return picture;
}

/// Traces paths from the light that hit the sensor.
PixelMeans traced_from_light(const Pair& pair, std::uint64_t seed) {
  const StageLights lights = pair.lights();
  const SensorEnd sensor = pair.end();
  PixelMeans picture(sensor);
  RandomStream random(seed, 92, 0);
  for (int i = 0; i < paths; ++i) {
    picture.begin_path();
    const EndPosition at = lights.sample_position(pair, random);
    const EndDirection to = lights.sample_direction(at, random);
    const double weight = to.strength / (at.position_density * to.density);
    const auto [x, d] = pair.leave(at.point, to.direction, random);
    sensor.hit(pair, x, d,
               [&](const EndHit& hit) { picture.add(hit.direction.pixel, weight * hit.value); });
  }
  return picture;
}

/// Connects positions on the light and the sensor by straight lines: |J| = r^2.
PixelMeans connected(const Pair& pair, std::uint64_t seed) {
  const StageLights lights = pair.lights();
  const SensorEnd sensor = pair.end();
  PixelMeans picture(sensor);
  RandomStream random(seed, 93, 0);
  for (int i = 0; i < paths; ++i) {
    picture.begin_path();
    const EndPosition y = lights.sample_position(pair, random);
    const EndPosition z = sensor.sample_position(pair, random);
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
  return {Vec3::Zero(), INFINITY, 1};
}
FaceLight disk_light() {
  return {Vec3(0.4, -0.3, 0.5), 0.9, 2.5};
}
FaceLight cap_light() {
  return {test_sphere.centre + test_sphere.radius * Vec3(1, 0, 0), 1.5, 0.8};
}

/// Checks the picture by paths from the sensor and, with `hit`, from the environment.
template <class Expected>
void check_in_environment(const Surface& boundary, const Sensor& sensor, bool hit,
                          const Expected& expected, std::uint64_t seed) {
  const Pair pair{boundary, environment(), sensor};
  traced_from_sensor(pair, seed).check(expected);
  if (hit) traced_from_light(pair, seed).check(expected);
}

/// Returns the mean of f(u, v) over a pixel.
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

}  // namespace

TEST_CASE("uniform environment: cameras measure L/n^2, detectors pi n^2 sin^2(acceptance)") {
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
    check_in_environment(test_box, radial_on_box(acceptance), true, irradiance, 7);
    check_in_environment(test_sphere, radial_on_sphere(acceptance), true, irradiance, 8);
    AreaDetector whole_face{Vec3(0.5, -0.5, 3), Vec3(0, 1, 0), 3, 3, {2, 3}, acceptance};
    check_in_environment(test_box, whole_face, true, irradiance, 6);
  }
}

TEST_CASE("uniform environment: the directional detector measures n^2 times the projected area") {
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

TEST_CASE("form factors of disk and rectangle and of sphere caps: agree with the closed form") {
  const double n = 1.3, h = 2.5, a = 0.9;
  const Vec3 up = Vec3(0.3, 1, 0).normalized(), right = Vec3::UnitZ().cross(up);
  const Vec3 between = area_on_box().centre - disk_light().centre;
  // from a Lambertian disk on a parallel surface element beside its axis
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
  traced_from_sensor(over, 1).check(on_box);
  traced_from_light(over, 2).check(on_box);
  connected(over, 3).check(on_box);

  const auto on_sphere = [&](int) { return n * n * 0.8 * pi * 1.5 * 1.5 / (4 * 1.7 * 1.7); };
  const Pair inside{test_sphere, cap_light(), area_on_sphere()};
  traced_from_sensor(inside, 4).check(on_sphere);
  traced_from_light(inside, 5).check(on_sphere);
  connected(inside, 6).check(on_sphere);
}

TEST_CASE("point light by direction: power over 4 pi, by hits and by connections") {
  const auto expected = [](int) { return 3 / (4 * pi); };
  for (const Sensor& sensor : {Sensor{directional(0.7)}, Sensor{polar(pi)}}) {
    const Pair pair{test_box, PointLight{Vec3(0.7, -1, 1.1), 3}, sensor};
    traced_from_light(pair, 1).check(expected);
    connected(pair, 2).check(expected);
  }
}

TEST_CASE("beam on an area detector: irradiance is power over area") {
  AreaDetector detector = area_on_box(0.1);
  const Pair pair{test_box, BeamLight{Vec3(0.6, -0.4, 1), Vec3(0, 0, 2), 1.05, 7}, detector};
  traced_from_light(pair, 1).check([](int) { return 7 / (pi * 1.05 * 1.05); });
}

TEST_CASE("Gaussian beam on an area detector: irradiance agrees with the closed form") {
  constexpr double radius = 0.49;
  const AreaDetector detector = area_on_box(0.1);
  const Vec3 right = Vec3(0, 0, 1).cross(detector.up.normalized()).normalized();
  const Vec3 up = right.cross(Vec3(0, 0, 1)), off(-0.1, -0.1, 0);
  const auto within = [](double low, double high) {
    return (std::erf(std::sqrt(2) * high / radius) - std::erf(std::sqrt(2) * low / radius)) / 2;
  };
  const Pair pair{test_box,
                  BeamLight{Vec3(0.6, -0.4, 1) + off, Vec3(0, 0, 1), radius, 7, Spread::gaussian},
                  detector};
  traced_from_light(pair, 1).check([&](int pixel) {
    const double u = 0.4 * (pixel % 4) - 0.8 - off.dot(right),
                 v = 0.6 - 0.4 * (pixel / 4) - off.dot(up);
    return 7 / (0.4 * 0.4) * within(u, u + 0.4) * within(v - 0.4, v);
  });
}

TEST_CASE("fibre: far field and accepted irradiance agree with the closed form") {
  constexpr double n = 1.3, aperture = 0.5, radius = 0.05;
  const Vec3 axis = directional(0.5).forward.normalized();
  for (const Spread spread : {Spread::even, Spread::gaussian}) {
    CAPTURE(static_cast<int>(spread));
    const FibreLight fibre{Vec3(0.4, -0.5, 1.7), axis, radius, aperture, 3, spread};
    const double sine = aperture / n;
    const double share = spread == Spread::even ? 1 : -std::expm1(-2 / (sine * sine));
    const auto per_sines = [&](double u, double v) {  // over the plane of sines
      const double squared = u * u + v * v;
      if (!(squared < 1)) return 0.0;
      if (spread == Spread::even) return squared < sine * sine ? 1 / (pi * sine * sine) : 0;
      return 2 / (pi * sine * sine * share) * std::exp(-2 * squared / (sine * sine));
    };
    const Pair far{test_box, fibre, directional(0.25), n};
    const double half = std::sin(0.25);
    const auto pattern = [&](int pixel) {
      return pixel_mean({4, 5}, pixel, half, half, [&](double u, double v) {
        return 3 * std::sqrt(std::max(0.0, 1 - u * u - v * v)) * per_sines(u, v);
      });
    };
    traced_from_light(far, 1).check(pattern);
    connected(far, 2).check(pattern);

    const double accepted = 0.2;  // rad
    const FibreLight up{Vec3(0.6, -0.4, 2.4), Vec3::UnitZ(), radius, aperture, 3, spread};
    const Pair near{test_box, up,
                    AreaDetector{Vec3(0.6, -0.4, 3), Vec3::UnitY(), 1, 1, {}, accepted}, n};
    const double ratio = std::sin(accepted) / sine;
    const double caught =
        3 * (spread == Spread::even ? ratio * ratio : -std::expm1(-2 * ratio * ratio) / share);
    traced_from_light(near, 3).check([&](int) { return caught; });
    connected(near, 4).check([&](int) { return caught; });
  }
}

TEST_CASE("lens cameras: pictures from the sensor, from the light and by connections agree") {
  const auto check = [](const Pair& pair, std::uint64_t seed) {
    CAPTURE(seed);
    const PixelMeans reference = connected(pair, seed);
    reference.check_like(traced_from_light(pair, seed));
    if (!std::holds_alternative<PointLight>(pair.light))
      reference.check_like(traced_from_sensor(pair, seed));
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

TEST_CASE(
    "pictures in an index field: from the sensor and from the light agree, with n^2 of the "
    "endpoint") {
  // bends light by some 15 degrees on its way across
  const Vec3 gradient(0.1, -0.07, 0.05);
  const auto space = [&](const Surface& boundary) -> std::shared_ptr<const Space> {
    return make_space(LinearRamp{0.4, gradient}, empty_stage(boundary),
                      {0.2, 100, Spreading::none});
  };
  const auto n_squared = [&](const Vec3& x) { return std::pow(1.4 + gradient.dot(x), 2); };
  const AreaDetector area = area_on_box();
  const Vec3 up = area.up.normalized(), right = Vec3::UnitZ().cross(up);
  const Pair box{test_box, environment(), area, 0, space(test_box)};
  traced_from_light(box, 1).check([&](int pixel) {
    return pixel_mean(area.pixels, pixel, 0.8, 0.6, [&](double u, double v) {
      return pi * n_squared(area.centre + u * right + v * up);
    });
  });
  const Pair sphere{test_sphere, environment(), lens_on_sphere(), 0, space(test_sphere)};
  traced_from_light(sphere, 2).check([](int) { return 1.0; });

  const Pair disk{test_box, disk_light(), area, 0, space(test_box)};
  traced_from_sensor(disk, 3).check_like(traced_from_light(disk, 4));
}

}  // namespace flatspeckle::grin::test_pictures
