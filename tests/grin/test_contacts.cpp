#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "bench/oracles/ray_scene.h"
#include "core/error.h"
#include "grin/media/fields/parabolic.h"
#include "grin/render/flights/space.h"
#include "grin/render/values/field_body.h"
#include "grin/trace/ray_tracing.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_contacts {

using oracles::Long3;
using oracles::SolidBody;
using oracles::SolidRay;
using oracles::SolidScene;
using Kind = SolidBody::Kind;
using flatspeckle::tests::is_night;

namespace {

constexpr double limit = 1e-9;
const Box stage_box{{-6, -6, -6}, {6, 6, 6}};

SolidBody ball(const Vec3& centre, double radius) {
  return {Kind::ball, {centre[0], centre[1], centre[2], radius}};
}
SolidBody block(const Vec3& low, const Vec3& high) {
  return {Kind::block, {low[0], low[1], low[2], high[0], high[1], high[2]}};
}
SolidBody lens(const Vec3& vertex, double radius, double front, double back, double thickness) {
  return {Kind::lens, {vertex[0], vertex[1], vertex[2], radius, front, back, thickness}};
}
SolidBody of(SolidBody body, double index, double extinction = 0) {
  body.index = index;
  body.extinction = extinction;
  return body;
}

Surface surface_of(const SolidBody& body) {
  const auto& s = body.shape;
  if (body.kind == Kind::ball) return Sphere{{s[0], s[1], s[2]}, s[3]};
  if (body.kind == Kind::block) return Box{{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
  return lens_of("lens", s);
}

SolidScene scene_of(const std::vector<SolidBody>& bodies, double index_around = 1) {
  SolidScene scene{bodies, index_around, 0, block(stage_box.low, stage_box.high)};
  return scene;
}

/// Part filled by an almost uniform index field, where rays are followed by steps: none, or the
/// part around the bodies.
constexpr int nowhere = -2, around_them = -1;

struct Staged {
  Stage stage;
  AnyIndexField field = Homogeneous{0};
};
Staged make(const SolidScene& solid, int curved) {
  Staged scene{.stage = {.boundary = stage_box}};
  int number = 0;
  for (const SolidBody& body : solid.bodies) {
    Body added{.surface = surface_of(body),
               .medium = {.mu_a = body.extinction},
               .excess = body.index - 1,
               .keys = "ball, "};
    if (number++ == curved) added.excess.reset();
    scene.stage.bodies.push_back(added);
  }
  sort_by_size(scene.stage.bodies);
  scene.stage.excess_around = solid.index_around - 1;
  const double index = curved >= 0 ? solid.bodies[curved].index : solid.index_around;
  if (curved == nowhere)
    scene.field = Homogeneous{index - 1};
  else
    scene.field = ParabolicGuide(ParabolicProfile{index - 1, 1e-7}, Vec3::Zero());
  check(scene.stage);
  return scene;
}

Long3 long_of(const Vec3& x) {
  return {x[0], x[1], x[2]};
}
double difference(const Vec3& x, const Long3& y) {
  double most = 0;
  for (int a = 0; a < 3; ++a) most = std::max(most, std::abs(static_cast<double>(x[a] - y[a])));
  return most;
}

TracedRay traced(const Staged& scene, const Vec3& x, const Vec3& d) {
  SceneField field;
  field.field = scene.field;
  field.scale = std::holds_alternative<Homogeneous>(scene.field) ? 0 : 1e7;
  const RayStops stops{{stage_box}, 1000, 1e-8};
  const RaySteps steps{Sharma(), 0.5, 1e-11};
  return trace_rays(field, scene.stage, stops, steps, {{x, d}}, 0).front();
}
double difference(const TracedRay& ray, const SolidRay& reference) {
  return std::max(
      {std::abs(static_cast<double>(ray.end.optical_path - reference.optical_path)),
       std::abs(static_cast<double>(ray.transmittance - reference.fresnel * reference.transmitted)),
       std::abs(static_cast<double>(ray.end.v.norm() - reference.index)),
       difference(ray.end.x, reference.x), difference(ray.end.v.normalized(), reference.d)});
}
double difference(const Flight& flight, const SolidRay& reference) {
  return std::max({std::abs(static_cast<double>(flight.optical_path - reference.optical_path)),
                   std::abs(static_cast<double>(flight.fresnel - reference.fresnel)),
                   std::abs(static_cast<double>(flight.weight - reference.transmitted)),
                   difference(flight.point.x, reference.x),
                   difference(flight.direction, reference.d)});
}

class Drawn {
 public:
  explicit Drawn(std::uint64_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int one_of(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    return Vec3(normal(random_), normal(random_), normal(random_)).normalized();
  }
  Vec3 place(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }

  SolidBody material(const SolidBody& body) {
    const double extinction = one_of(2) ? uniform(0, 0.5) : 0;
    return of(body, one_of(4) ? uniform(1, 2) : 1, extinction);
  }
  /// Returns 0 or a gap that coordinates resolve.
  double gap() {
    constexpr double gaps[] = {0, 0, 0, 1e-12, 1e-11, 1e-10, 1e-9, 1e-6, 0.1};
    return gaps[one_of(9)];
  }
  SolidBody any() {
    const Vec3 x = place(1);
    switch (one_of(3)) {
      case 0:
        return ball(x, uniform(0.3, 1));
      case 1:
        return block(x, x + Vec3(uniform(0.3, 1.5), uniform(0.3, 1.5), uniform(0.3, 1.5)));
      default:
        return any_lens(x);
    }
  }
  SolidBody any_lens(const Vec3& x) {
    const double radius = uniform(0.3, 0.8), thickness = uniform(0.9, 2);
    return lens(x, radius, curvature(radius), curvature(radius), thickness);
  }
  double curvature(double radius) {
    constexpr double large[] = {1e3, 1e9, 1e15, 1e30};
    const double side = one_of(2) ? 1 : -1;
    switch (one_of(4)) {
      case 0:
        return 0;
      case 1:
        return side * large[one_of(4)];
      default:
        return side * uniform(1.3, 5) * radius;
    }
  }

  /// Returns a body beside, in or around this one, in contact or nearly so.
  SolidBody touching(const SolidBody& body) {
    const auto& s = body.shape;
    const double g = gap();
    if (body.kind == Kind::ball) {
      const Vec3 centre(s[0], s[1], s[2]), d = direction();
      const double r = uniform(0.2, 0.9) * s[3];
      switch (one_of(4)) {
        case 0:
          return ball(centre + (s[3] + r + g) * d, r);
        case 1:
          return ball(centre + (s[3] - r - g) * d, r);
        case 2:
          return ball(centre, s[3] - (g > 0 ? g : 0.1));
        default: {
          const Vec3 low(s[0] - r, s[1] - r, s[2] + s[3] + g);
          return block(low, low + Vec3(2 * r, 2 * r, r));
        }
      }
    }
    if (body.kind == Kind::block) {
      const Vec3 low(s[0], s[1], s[2]), high(s[3], s[4], s[5]);
      const int axis = one_of(3);
      const bool above = one_of(2);
      Vec3 from = low, to = high;
      switch (one_of(4)) {
        case 0:  // on a face
          (above ? from : to)[axis] = (above ? high : low)[axis] + (above ? g : -g);
          (above ? to : from)[axis] = from[axis] + (above ? 1 : -1) * uniform(0.2, 0.8);
          if (!above) from[axis] = to[axis] - uniform(0.2, 0.8);
          if (one_of(2)) to[(axis + 1) % 3] += uniform(-0.1, 0.3);
          return block(from, to);
        case 1:  // inside, sharing faces
          (above ? from : to)[axis] = low[axis] + uniform(0.3, 0.7) * (high - low)[axis];
          (above ? to : from)[axis] += above ? -g : g;
          if (one_of(2)) to[(axis + 1) % 3] -= 0.3 * (high - low)[(axis + 1) % 3];
          return block(from, to);
        case 2: {  // a ball on a face, inside or outside
          const double r = uniform(0.1, 0.14);
          Vec3 centre = (low + high) / 2;
          centre[axis] = (above ? high : low)[axis] + (one_of(2) ? 1 : -1) * (r + g);
          return ball(centre, r);
        }
        default: {  // a lens on the upper face
          const double radius = uniform(0.2, 0.5), back = curvature(radius);
          return lens({(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2] + g}, radius, 0,
                      back, uniform(0.7, 1));
        }
      }
    }
    // a lens behind it, cemented, or a ball inside
    if (one_of(2)) {
      return lens({s[0], s[1], s[2] + s[6] + g}, s[3], s[5], curvature(s[3]), uniform(1, 2));
    }
    const double r = uniform(0.1, 0.25);
    return ball({s[0], s[1], s[2] + s[6] / 2}, r);
  }

  SolidScene scene() {
    std::vector<SolidBody> bodies{material(any())};
    const int count = 1 + one_of(5);
    while (static_cast<int>(bodies.size()) < count) {
      const SolidBody& beside = bodies[one_of(static_cast<int>(bodies.size()))];
      bodies.push_back(material(one_of(5) ? touching(beside) : any()));
    }
    return scene_of(bodies, one_of(3) ? 1 : uniform(1, 1.6));
  }

 private:
  std::mt19937_64 random_;
};

/// Results of comparing rays of random scenes with the oracle.
struct Comparison {
  int scenes = 0, rays = 0, undecided = 0;
  double largest = 0;
};

/// Calls compare(scene, solid, x, d) for rays that start outside all bodies or anywhere among them,
/// and collects the differences that it returns; nullopt stands for an undecided ray.
template <class Compare>
Comparison compared(std::uint64_t seed, int scenes, const Compare& compare) {
  constexpr int rays = 12;
  Comparison all;
  for (int number = 0; number < scenes; ++number) {
    Drawn drawn(seed * 1'000'000 + static_cast<std::uint64_t>(number));
    SolidScene solid = drawn.scene();
    const int curved = drawn.one_of(static_cast<int>(solid.bodies.size()) + 2) - 2;
    // a field is another medium even where its index is the same
    if (curved >= 0) solid.bodies[curved].index = drawn.uniform(1, 2);
    if (curved == around_them) solid.index_around = drawn.uniform(1.01, 1.6);
    std::optional<Staged> scene;
    try {
      scene = make(solid, curved);
    } catch (const InputError&) {
      continue;  // a body drawn twice, or an impossible lens
    }
    ++all.scenes;
    for (int ray = 0; ray < rays; ++ray) {
      const Vec3 towards = drawn.place(1.2), away = 5 * drawn.direction();
      const Vec3 x = ray % 3 ? Vec3(away) : drawn.place(1.2);
      const Vec3 d = ray % 3 ? Vec3((towards - x).normalized()) : drawn.direction();
      CAPTURE(number);
      CAPTURE(ray);
      CAPTURE(curved);
      const std::optional<double> difference = compare(*scene, solid, x, d);
      ++all.rays;
      if (!difference) {
        ++all.undecided;
        continue;
      }
      all.largest = std::max(all.largest, *difference);
      CHECK(*difference < limit);
    }
  }
  return all;
}

void check(const Comparison& all, int scenes) {
  MESSAGE(all.scenes << " scenes, " << all.rays << " rays, " << all.undecided
                     << " undecided, largest difference " << all.largest);
  CHECK(all.scenes >= scenes);
  CHECK(all.undecided < 0.03 * all.rays);
}

/// Largest number of crossings of a ray, as total reflection traps rays that nothing absorbs.
constexpr int most_crossings = 60;

std::optional<double> compare_traced(const Staged& scene, const SolidScene& solid, const Vec3& x,
                                     const Vec3& d) {
  const auto reference =
      oracles::follow_decided(solid, long_of(x), long_of(d), nullptr, most_crossings);
  if (!reference) return std::nullopt;
  return difference(traced(scene, x, d), *reference);
}

std::optional<double> compare_flown(const Staged& scene, const SolidScene& solid, const Vec3& x,
                                    const Vec3& d) {
  const auto space =
      make_space(scene.field, scene.stage, {.step = 0.05, .spreading = Spreading::none});
  RandomStream random(7, static_cast<std::uint64_t>(1e6 * std::abs(x[0] + d[1])), 0);
  const Flight flight = space->fly({x, Regions(scene.stage).at(x, d)}, d, random);
  if (flight.end != Flight::End::boundary || !flight.is_connectable) return std::nullopt;
  std::vector<bool> reflects;
  for (int i = 0; i < flight.crossings.count; ++i) reflects.push_back(flight.crossings.reflects(i));
  const auto reference =
      oracles::follow_decided(solid, long_of(x), long_of(d), &reflects, most_crossings);
  if (!reference) return std::nullopt;
  if (reference->crossings != flight.crossings.count) return 1;
  return difference(flight, *reference);
}

}  // namespace

TEST_CASE(
    "gaps and films of any width: rays agree with an oracle, below 1e-12 with or without the gap") {
  const Vec3 x(-0.3, 0.1, -2), d = Vec3(0.2, -0.1, 1).normalized();
  const auto with_gap = [](double gap) {
    return scene_of(
        {of(block({-1, -1, 0}, {1, 1, 0.7}), 1.5), of(block({-1, -1, 0.7 + gap}, {1, 1, 2}), 1.3)});
  };
  const auto nested = [](double gap) {
    return scene_of({of(ball({0, 0, 0}, 1), 1.5), of(ball({0, 0, 0}, 1 - gap), 1.3)});
  };
  const auto none = oracles::follow(with_gap(0), long_of(x), long_of(d));
  const auto bare =
      oracles::follow(scene_of({of(ball({0, 0, 0}, 1), 1.3)}), long_of(x), long_of(d));
  for (int tenth = -160; tenth <= 0; tenth += 5) {
    const double gap = std::pow(10, 0.1 * tenth) / (tenth > -5 ? 2 : 1);
    CAPTURE(gap);
    for (const int curved : {nowhere, around_them, 0, 1}) {
      CAPTURE(curved);
      const auto apart = oracles::follow(with_gap(gap), long_of(x), long_of(d));
      const double as_is = difference(traced(make(with_gap(gap), curved), x, d), *apart);
      if (gap > 1e-12)
        CHECK(as_is < limit);
      else
        CHECK(std::min(as_is, difference(traced(make(with_gap(gap), curved), x, d), *none)) <
              limit);
      if (gap < 1e-14) continue;  // the surfaces coincide, and the scene is rejected
      const auto shell = oracles::follow(nested(gap), long_of(x), long_of(d));
      const auto ray = traced(make(nested(gap), curved), x, d);
      const double of_shell = difference(ray, *shell);
      CHECK((gap > 1e-12 ? of_shell : std::min(of_shell, difference(ray, *bare))) < limit);
    }
  }
  CHECK_THROWS_AS(make(nested(0), nowhere), InputError);
  CHECK_THROWS_AS(make(nested(1e-16), nowhere), InputError);
}

TEST_CASE(
    "plates of any thickness: rays by long steps agree with an oracle, or the plate is rejected") {
  const Vec3 x(-0.3, 0.1, -2), d = Vec3(0.2, -0.1, 1).normalized();
  for (int tenth = -160; tenth <= 0; tenth += 5) {
    const double thickness = std::pow(10, 0.1 * tenth);
    CAPTURE(thickness);
    const SolidScene solid =
        scene_of({of(block({-1, -1, 0.7}, {1, 1, 0.7 + thickness}), 1.5)}, 1.2);
    const auto reference = oracles::follow(solid, long_of(x), long_of(d));
    for (const int curved : {nowhere, around_them, 0}) {
      CAPTURE(curved);
      if (thickness < 1e-13)
        CHECK_THROWS_AS(make(solid, curved), InputError);
      else if (thickness > 1e-12)
        CHECK(difference(traced(make(solid, curved), x, d), *reference) < limit);
    }
  }
}

TEST_CASE(
    "lenses of any radius of curvature: rays agree with an oracle, beyond 1e12 with plane faces") {
  const Vec3 x(-0.3, 0.1, -2), d = Vec3(0.2, -0.1, 1).normalized();
  const auto flat =
      oracles::follow(scene_of({of(lens({0, 0, 0}, 0.9, 0, 0, 1), 1.5)}), long_of(x), long_of(d));
  for (int tenth = 0; tenth <= 3000; tenth += tenth < 200 ? 5 : 100) {
    for (const double side : {-1, 1}) {
      const double radius = side * std::pow(10, 0.1 * tenth);
      CAPTURE(radius);
      for (const SolidBody& body :
           {lens({0, 0, 0}, 0.9, radius, 0, 3), lens({0, 0, 0}, 0.9, 0, radius, 3),
            lens({0, 0, 0}, 0.9, radius, radius, 1)}) {
        const SolidScene solid = scene_of({of(body, 1.5)});
        const auto reference = oracles::follow(solid, long_of(x), long_of(d));
        for (const int curved : {nowhere, 0})
          CHECK(difference(traced(make(solid, curved), x, d), *reference) < limit);
        if (radius > 1e12 && body.shape[6] == 1)
          CHECK(difference(traced(make(solid, nowhere), x, d), *flat) < limit);
      }
    }
  }
}

TEST_CASE(
    "balls and lens barrels of radii up to 1e50: crossings agree with the closed form and with "
    "planes") {
  const Vec3 x(-0.3, 0.1, -2), d = Vec3(0.2, -0.1, 1).normalized();
  const auto end_on = [&](const Surface& surface) {
    const Stage stage{.boundary = stage_box};
    return trace_rays({}, stage, {{surface}, 1000, 1e-10}, {Sharma(), 0.5, 1e-11}, {{x, d}}, 0)
        .front()
        .end;
  };
  const RayState on_plane = end_on(Plane{{0, 0, 0}, Vec3::UnitZ()});
  for (int tenth = 5; tenth <= 500; tenth += tenth < 200 ? 5 : 50) {
    const double radius = std::pow(10, 0.1 * tenth);
    CAPTURE(radius);
    const RayState on_ball = end_on(Sphere{{0, 0, radius}, radius});
    const long double z = on_ball.x[2], rho_squared = on_ball.x.head<2>().squaredNorm();
    const long double sag =
        rho_squared / (radius + std::sqrt(1.0L * radius * radius - rho_squared));
    CHECK(static_cast<double>(std::abs(z - sag)) < 1e-14);
    if (radius > 1e12) CHECK((on_ball.x - on_plane.x).norm() < 1e-11);
    const Vec3 along(1, 0.2, 0.1), from(-2, 0.1, 0.5);
    const Lens rod = *Lens::make({radius, 0, 0}, radius, 0, 0, 1);
    const double ray_length = entry_distance(rod, from, along.normalized());
    const Vec3 at = from + ray_length * along.normalized();
    const long double off =
        at[1] * at[1] / (radius + std::sqrt(1.0L * radius * radius - at[1] * at[1]));
    CHECK(std::abs(static_cast<double>(at[0] - off)) < 1e-14);
  }
}

TEST_CASE("rays through touching, nested and nearly coincident bodies agree with an oracle") {
  check(compared(1, is_night ? 200 : 40, compare_traced), is_night ? 150 : 30);
}

TEST_CASE("flights through touching, nested and nearly coincident bodies agree with an oracle") {
  check(compared(2, is_night ? 200 : 40, compare_flown), is_night ? 150 : 30);
}

TEST_CASE("nightly: rays through 500 random scenes agree with an oracle") {
  check(compared(3, 700, compare_traced), 500);
}

TEST_CASE("nightly: flights through 500 random scenes agree with an oracle") {
  check(compared(4, 700, compare_flown), 500);
}

}  // namespace flatspeckle::grin::test_contacts
