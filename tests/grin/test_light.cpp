#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/lights/light.h"
#include "tests/grin/path_endpoints.h"

namespace flatspeckle::grin::test_light {

namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Space>
StageLights lights_in(const Surface& boundary, std::vector<Light> lights, const Space& space) {
  return {std::move(lights), empty_stage(boundary),
          [space](const PathPoint& p) { return space.index(p); }};
}

FaceLight disk_light() {
  return {Vec3(0.4, -0.3, 0.5), 0.9, 2.5};
}
FaceLight cap_light() {
  return {test_sphere.centre + test_sphere.radius * Vec3(2, -1, 2) / 3, 1.9, 0.8};
}
FaceLight environment(double radiance = 1) {
  return {Vec3::Zero(), infinity, radiance};
}

/// Returns a fibre on the lower face of the box; tilted_fibre() is inside the box.
FibreLight fibre(double aperture, Spread spread = Spread::even) {
  return {Vec3(0.3, -0.4, 0.5), Vec3(0, 0, 1), 0.3, aperture, 2, spread};
}
FibreLight tilted_fibre(Spread spread) {
  return {Vec3(0.3, -0.4, 1.7), Vec3(1, -2, 1).normalized(), 0.3, 0.9, 2, spread};
}

/// Returns the mean of strength / density over samples, which is the power.
template <class Space>
Average sampled_power(const StageLights& lights, const Space& space, std::uint64_t seed) {
  Average power;
  RandomStream random(seed, 81, 0);
  for (int i = 0; i < 100000; ++i) {
    const EndPosition at = lights.sample_position(space, random);
    const EndDirection to = lights.sample_direction(at, random);
    power.add(to.strength / (at.position_density * to.density));
  }
  return power;
}

std::string error_message(const Surface& boundary, std::vector<Light> lights) {
  try {
    lights_in(boundary, std::move(lights), UniformSpace{});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Checks the fractions of sampled positions in the parts of a surface that `part` numbers.
template <class Part>
void check_positions(const StageLights& lights, const Part& part, const std::vector<double>& shares,
                     std::uint64_t seed) {
  std::vector<double> counts(shares.size());
  RandomStream random(seed, 82, 0);
  for (int i = 0; i < 100000; ++i)
    ++counts[part(lights.sample_position(UniformSpace{}, random).point.x)];
  flatspeckle::tests::check_chi_square(counts, shares);
}

int of(double share, int parts) {
  return std::clamp(static_cast<int>(share * parts), 0, parts - 1);
}

}  // namespace

TEST_CASE("lights: sampled directions agree with their density") {
  RandomStream random(1, 83, 0);
  const auto check = [&](const StageLights& lights, std::uint64_t seed) {
    const EndPosition at = lights.sample_position(TiltedSpace{}, random);
    const Vec3 axis = Vec3(1, 2, -3).normalized();
    check_directions([&](RandomStream& r) { return lights.sample_direction(at, r); },
                     [&](const Vec3& d) { return lights.towards(at, d); }, axis, seed);
  };
  check(lights_in(test_box, {PointLight{Vec3(0, 0, 1)}}, TiltedSpace{}), 1);
  check(lights_in(test_box, {disk_light()}, TiltedSpace{}), 2);
  check(lights_in(test_sphere, {cap_light()}, TiltedSpace{}), 3);
  for (const Spread spread : {Spread::even, Spread::gaussian}) {
    check(lights_in(test_box, {tilted_fibre(spread)}, TiltedSpace{}), 9);
    check(lights_in(test_box, {fibre(0.4, spread)}, TiltedSpace{}), 10);
  }
}

TEST_CASE("lights: sampled positions are uniform by area") {
  const Vec3 size = test_box.high - test_box.low;
  // 4 x 4 parts of each of the six faces
  std::vector<double> shares;
  const double area = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < 16; ++i) shares.push_back(size.prod() / size[face / 2] / area / 16);
  const auto part_of_box = [&](const Vec3& x) {
    const Vec3 outward = test_box.normal(x);
    int axis;
    outward.cwiseAbs().maxCoeff(&axis);
    const Vec3 t = (x - test_box.low).cwiseQuotient(size);
    CHECK(std::abs(test_box.distance(x)) < 1e-12);
    return (2 * axis + (outward[axis] > 0)) * 16 + of(t[(axis + 1) % 3], 4) * 4 +
           of(t[(axis + 2) % 3], 4);
  };
  check_positions(lights_in(test_box, {environment()}, UniformSpace{}), part_of_box, shares, 4);

  // equal heights of a sphere, and of a cap, have equal areas
  const auto part_of_cap = [&](const Vec3& axis, double height) {
    return [=](const Vec3& x) {
      const Vec3 r = x - test_sphere.centre;
      CHECK(std::abs(test_sphere.distance(x)) < 1e-12);
      CHECK(test_sphere.radius - r.dot(axis) <= height * (1 + 1e-12));
      const double azimuth =
          std::atan2(r.dot(frame_across(axis).col(1)), r.dot(frame_across(axis).col(0)));
      return of((test_sphere.radius - r.dot(axis)) / height, 8) * 8 +
             of(azimuth / (2 * pi) + 0.5, 8);
    };
  };
  const std::vector<double> equal(64, 1.0 / 64);
  check_positions(lights_in(test_sphere, {environment()}, UniformSpace{}),
                  part_of_cap(Vec3::UnitX(), 2 * test_sphere.radius), equal, 5);
  const double chord = cap_light().radius;
  check_positions(lights_in(test_sphere, {cap_light()}, UniformSpace{}),
                  part_of_cap(Vec3(2, -1, 2) / 3, chord * chord / (2 * test_sphere.radius)), equal,
                  6);

  // equal squares of radii of a disk
  const auto part_of_disk = [](const Vec3& centre, const Vec3& axis, double radius) {
    return [=](const Vec3& x) {
      const Vec3 r = x - centre;
      CHECK(std::abs(r.dot(axis)) < 1e-12);
      CHECK(r.norm() <= radius * (1 + 1e-12));
      const double azimuth =
          std::atan2(r.dot(frame_across(axis).col(1)), r.dot(frame_across(axis).col(0)));
      return of(r.squaredNorm() / (radius * radius), 8) * 8 + of(azimuth / (2 * pi) + 0.5, 8);
    };
  };
  check_positions(lights_in(test_box, {disk_light()}, UniformSpace{}),
                  part_of_disk(disk_light().centre, Vec3::UnitZ(), 0.9), equal, 7);
  const Vec3 along = Vec3(1, 1, 0.5).normalized();
  check_positions(lights_in(test_box, {BeamLight{Vec3(0, 0, 1.5), along, 0.4}}, UniformSpace{}),
                  part_of_disk(Vec3(0, 0, 1.5), along, 0.4), equal, 8);
  check_positions(lights_in(test_box, {fibre(0.2)}, UniformSpace{}),
                  part_of_disk(fibre(0.2).centre, Vec3::UnitZ(), 0.3), equal, 9);
}

TEST_CASE("Gaussian beams and fibres: sampled positions agree with a Gaussian density") {
  constexpr double radius = 0.25;
  const Vec3 centre(0.2, -0.3, 1.5), along = Vec3(1, 1, 0.5).normalized();
  // fractions in rings of equal width: exp(-2 r^2 / radius^2), cut at 3 radii
  constexpr int rings = 24;
  const auto beyond = [&](double r) { return std::exp(-2 * r * r / (radius * radius)); };
  std::vector<double> shares(rings);
  for (int i = 0; i < rings; ++i)
    shares[i] = beyond(3 * radius * i / rings) - beyond(3 * radius * (i + 1) / rings);
  for (double& share : shares) share /= 1 - beyond(3 * radius);
  const auto ring = [&](const Vec3& x) {
    CHECK(std::abs((x - centre).dot(along)) < 1e-12);
    return of((x - centre).norm() / (3 * radius), rings);
  };
  for (const Light& light : {Light{BeamLight{centre, along, radius, 2, Spread::gaussian}},
                             Light{FibreLight{centre, along, radius, 0.2, 2, Spread::gaussian}}}) {
    const StageLights lights = lights_in(test_box, {light}, UniformSpace{});
    check_positions(lights, ring, shares, 10);
    RandomStream random(1, 86, 0);
    for (int i = 0; i < 100; ++i) {
      const EndPosition at = lights.sample_position(UniformSpace{}, random);
      const double expected = 2 / (pi * radius * radius) * beyond((at.point.x - centre).norm());
      CHECK(at.position_density == doctest::Approx(expected).epsilon(1e-7));
    }
  }
}

TEST_CASE("lights: strength integrated over positions and directions is the power") {
  const double n = 1.5, box_area = 2 * (3 * 3 + 3 * 2.5 + 2.5 * 3);
  const auto in_box = [&](Light light) { return lights_in(test_box, {light}, UniformSpace{n}); };
  const auto in_sphere = [&](Light light) {
    return lights_in(test_sphere, {light}, UniformSpace{n});
  };
  const auto check = [&](const StageLights& lights, double power, std::uint64_t seed) {
    CHECK(lights.power() == doctest::Approx(power).epsilon(1e-12));
    sampled_power(lights, UniformSpace{n}, seed).check(power);
  };
  check(in_box(PointLight{Vec3(0, 0, 1), 3}), 3, 1);
  check(in_box(BeamLight{Vec3(0, 0, 0.5), Vec3(0, 0, 5), 0.4, 3}), 3, 2);
  check(in_box(BeamLight{Vec3(0, 0, 1.5), Vec3(0, 0, 1), 0.2, 3, Spread::gaussian}), 3, 8);
  for (const Spread spread : {Spread::even, Spread::gaussian}) {
    check(in_box(fibre(0.4, spread)), 2, 9);
    check(in_box(tilted_fibre(spread)), 2, 10);
  }
  check(in_box(disk_light()), pi * n * n * 2.5 * pi * 0.9 * 0.9, 3);
  check(in_box(environment(0.7)), pi * n * n * 0.7 * box_area, 4);
  check(in_sphere(cap_light()), pi * n * n * 0.8 * pi * 1.9 * 1.9, 5);
  check(in_sphere(environment(0.7)), pi * n * n * 0.7 * 4 * pi * 1.7 * 1.7, 6);

  // n^2 over a disk: the mean of (n0 + g.r)^2 is n0^2 + |g|^2 r^2/4, g along the disk
  const TiltedSpace tilted;
  const double n0 = tilted.index({disk_light().centre});
  const double mean = n0 * n0 + (0.1 * 0.1 + 0.07 * 0.07) * 0.9 * 0.9 / 4;
  const double power = pi * mean * 2.5 * pi * 0.9 * 0.9;
  const StageLights lights = lights_in(test_box, {disk_light()}, tilted);
  sampled_power(lights, tilted, 7).check(power);
  CHECK(lights.power() == doctest::Approx(power).epsilon(2e-3));  // estimated from 4096 points
}

TEST_CASE("several lights: drawn in proportion to their powers, which add up") {
  const double n = 1.2;
  const std::vector<Light> mixed = {PointLight{Vec3(0, 0, 1), 2}, disk_light(),
                                    BeamLight{Vec3(0, 0, 1), Vec3(0, 1, 1), 0.3, 5},
                                    environment(0.01), PointLight{Vec3(1, 0, 2), 1e-9}};
  const StageLights lights = lights_in(test_box, mixed, UniformSpace{n});
  double sum = 0;
  for (const Light& light : mixed) sum += lights_in(test_box, {light}, UniformSpace{n}).power();
  CHECK(lights.power() == doctest::Approx(sum).epsilon(1e-12));
  std::vector<double> counts(5), shares;
  for (const Light& light : mixed)
    shares.push_back(lights_in(test_box, {light}, UniformSpace{n}).power() / sum);
  std::vector<Average> powers(5);
  RandomStream random(11, 84, 0);
  for (int i = 0; i < 100000; ++i) {
    const EndPosition at = lights.sample_position(UniformSpace{n}, random);
    const EndDirection to = lights.sample_direction(at, random);
    ++counts[at.light];
    for (int light = 0; light < 4; ++light)
      powers[light].add(light == at.light ? to.strength / (at.position_density * to.density) : 0);
  }
  for (int light = 0; light < 4; ++light) {
    CAPTURE(light);
    powers[light].check(shares[light] * sum);
    const double error = std::sqrt(shares[light] * (1 - shares[light]) * 100000);
    CHECK(std::abs(counts[light] - 100000 * shares[light]) < 4 * error);
  }
}

TEST_CASE("lights: hits agree with samples") {
  check_hits(lights_in(test_box, {disk_light()}, TiltedSpace{}), TiltedSpace{}, 1);
  check_hits(lights_in(test_box, {environment()}, TiltedSpace{}), TiltedSpace{}, 2);
  check_hits(lights_in(test_box, {environment(), disk_light()}, TiltedSpace{}), TiltedSpace{}, 3);
  check_hits(lights_in(test_sphere, {cap_light()}, TiltedSpace{}), TiltedSpace{}, 4);
  check_hits(lights_in(test_sphere, {environment()}, TiltedSpace{}), TiltedSpace{}, 5);
}

TEST_CASE("face light: hits have its L/n^2 at any index and angle, and none are beside it") {
  const StageLights lights = lights_in(test_box, {disk_light()}, TiltedSpace{});
  const auto value = [&](const Vec3& x, const Vec3& d) {
    double sum = 0;
    lights.hit(TiltedSpace{}, x, d.normalized(), [&](const EndHit& hit) { sum += hit.value; });
    return sum;
  };
  for (const Vec3& d : {Vec3(0, 0, -1), Vec3(1, 2, -1), Vec3(5, 0, -0.01)})
    CHECK(value(Vec3(0.9, 0.2, 0.5), d) == doctest::Approx(2.5).epsilon(1e-12));
  CHECK(value(Vec3(0.4, 0.61, 0.5), Vec3(0, 0, -1)) == 0);
  CHECK(value(Vec3(0.4, -0.3, 3), Vec3(0, 0, 1)) == 0);
  CHECK(value(Vec3(0.4, 0.59, 0.5), Vec3(0, 0, -1)) > 0);
}

TEST_CASE("fibre light: sampled directions agree with the values towards them") {
  RandomStream random(1, 87, 0);
  for (const Spread spread : {Spread::even, Spread::gaussian}) {
    const StageLights lights = lights_in(test_box, {tilted_fibre(spread)}, TiltedSpace{});
    for (int i = 0; i < 1000; ++i) {
      const EndPosition at = lights.sample_position(TiltedSpace{}, random);
      const EndDirection to = lights.sample_direction(at, random);
      check_same(to, lights.towards(at, to.direction));
      CHECK((to.strength > 0 && to.direction.dot(at.inward) > 0));
      CHECK(at.is_point);
    }
  }
}

TEST_CASE("point and beam lights: not hit, beams not connected, points may be in a body") {
  Stage stage = empty_stage(test_box);
  stage.bodies.push_back({Sphere{Vec3(0, 0, 1.5), 0.5}});
  const StageLights lights(
      {PointLight{Vec3(0, 0, 1.2)}, BeamLight{Vec3(0, 0, 2.5), Vec3(0, 1, 0), 0.1}}, stage,
      [](const PathPoint&) { return 1.0; });
  lights.hit(UniformSpace{}, Vec3(0, 0, 0.5), Vec3(0, 0, -1), [](const EndHit&) { CHECK(false); });
  RandomStream random(1, 85, 0);
  bool seen[2] = {};
  for (int i = 0; i < 100; ++i) {
    const EndPosition at = lights.sample_position(UniformSpace{}, random);
    seen[at.light] = true;
    CHECK(at.is_point == (at.light == 0));
    CHECK(at.is_beam == (at.light == 1));
    CHECK(at.point.part == (at.light == 0 ? Part{1} : around));
    const EndDirection to = lights.sample_direction(at, random);
    if (!at.is_beam) continue;
    CHECK((to.direction - Vec3(0, 1, 0)).norm() < 1e-15);
    CHECK(lights.towards(at, to.direction).strength == 0);
  }
  CHECK((seen[0] && seen[1]));
}

TEST_CASE("lights: invalid ones are rejected by name") {
  const double nan = std::nan("");
  const auto refused = [](const Surface& boundary, Light light, const std::string& words) {
    const std::string line = error_message(boundary, {light});
    CAPTURE(line);
    CHECK(line.find(words) != std::string::npos);
    CHECK(line.find('\n') == std::string::npos);
  };
  CHECK(error_message(test_box, {}).starts_with("light is not given"));
  CHECK(error_message(test_box, {disk_light(), environment()}).empty());
  refused(test_box, PointLight{Vec3(0, 0, 0)}, "point_light, position = 0 0 0: must be inside");
  refused(test_box, PointLight{Vec3(0, nan, 1)}, "point_light, position");
  refused(test_box, BeamLight{Vec3(0, 0, 1), Vec3::Zero(), 1}, "beam_light, direction");
  refused(test_box, BeamLight{Vec3(0, 0, 0.5), Vec3(0, 0, -1), 0.5}, "must point into the stage");
  refused(test_box, BeamLight{Vec3(0, 0, 0.5), Vec3(0, 0, 1), 1.1}, "beam_light, radius = 1.1");
  refused(test_box, BeamLight{Vec3(0, 0, 0.5), Vec3(0, 1, 1), 0.5}, "must be inside the stage");
  refused(test_box, BeamLight{Vec3(0, 0, 0.5), Vec3(0, 0, 1), 0.5, 1, Spread::gaussian},
          "gaussian_beam, radius = 0.5: the light, a disk of radius 1.5 perpendicular");
  refused(test_box, FibreLight{Vec3(0, 0, 0.5), Vec3(0, 0, 1), 1.1, 0.2}, "fibre_light, radius");
  refused(test_box, FibreLight{Vec3(0, 0, 0.5), Vec3(0, 0, -1), 0.1, 0.2},
          "fibre_light, direction");
  refused(test_box, FibreLight{Vec3(0, 0, 0.5), Vec3(0, 0, 1), 0.1, 1.2, 1, Spread::gaussian},
          "gaussian_fibre, aperture = 1.2: must be at most the index of refraction at the fibre");
  refused(test_box, FaceLight{Vec3(0, 0, 0.5), 1.01}, "within one face of the boundary");
  refused(test_box, FaceLight{Vec3(0, 0, 0.6), 0.1}, "must be on the boundary");
  refused(test_box, FaceLight{Vec3(0, nan, 0.5), 0.1}, "face_light, position");
  refused(test_sphere, FaceLight{cap_light().centre, 3.5}, "face_light, radius = 3.5");
  for (const double radius : {0.0, -1.0, nan, -infinity})
    refused(test_sphere, FaceLight{cap_light().centre, radius}, "face_light, radius");
  refused(Plane{Vec3::Zero(), Vec3::UnitZ()}, environment(), "requires a sphere or a box");
  refused(test_box, BeamLight{Vec3(0, 0, 1), Vec3(0, 0, 1), 1e-200}, "light = 1: must have a size");
}

}  // namespace flatspeckle::grin::test_light
