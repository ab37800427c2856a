#include <numbers>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "bench/oracles/harmonic_ball.h"
#include "bench/scenes/random_fields.h"
#include "core/numbers/random.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/scattering/start_directions.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin::test_spreading {

using bench::random_direction;
using bench::random_point;
using oracles::HarmonicBall;
using std::numbers::pi;

namespace {

struct Traced {
  RayState end;
  double spreading;
  int caustics;
};

template <class Step, IndexField F>
Traced traced(const F& field, RayState ray, double sigma, int steps) {
  const RayState start = ray;
  const double n_start = start.v.norm();
  RayTangent tangent;
  CausticCount caustics(n_start, start.v);
  for (int i = 0; i < steps; ++i) {
    Step::step(field, ray, tangent, sigma / steps);
    caustics.pass(ray, tangent);
  }
  return {ray, signed_spreading(tangent, n_start, start.v, ray.v), caustics.count()};
}

/// Returns the signed J of C27: n0^2 sin^2 sigma (v0hat . vfhat).
double harmonic_spreading(const Vec3& x0, const Vec3& v0, double sigma) {
  const Vec3 v = -std::sin(sigma) * x0 + std::cos(sigma) * v0;
  return v0.squaredNorm() * std::pow(std::sin(sigma), 2) * v0.normalized().dot(v.normalized());
}

template <class Step>
void check_harmonic(int steps, double tolerance) {
  const HarmonicBall field{{}};
  RandomStream random(61, 0, 0);
  for (int i = 0; i < 200; ++i) {
    const RayState start = start_ray(field, random_point(random, 1), random_direction(random));
    const double sigma = 3 * pi * random.uniform();
    const double exact = harmonic_spreading(start.x, start.v, sigma);
    const Traced ray = traced<Step>(field, start, sigma, steps);
    CAPTURE(sigma);
    CAPTURE(exact);
    // relative, except near caustics
    const double scale = std::max(std::abs(exact), 1e-2 * start.v.squaredNorm());
    CHECK(std::abs(ray.spreading - exact) <= tolerance * scale);
  }
}

/// Checks reciprocity between a ray and the one back from its end, whose speed is the index there.
template <IndexField F>
void check_reciprocal(const F& field, RandomStream& random, int steps) {
  const RayState start = start_ray(field, random_point(random, 0.5), random_direction(random));
  const Traced there = traced<Yoshida4>(field, start, 1, steps);
  const RayState turned = start_ray(field, there.end.x, -there.end.v);
  const Traced back = traced<Yoshida4>(field, turned, 1, steps);
  CHECK((back.end.x - start.x).norm() < 1e-8);
  CHECK(back.spreading / turned.v.squaredNorm() ==
        doctest::Approx(there.spreading / start.v.squaredNorm()).epsilon(1e-8).scale(0));
  CHECK(back.caustics == there.caustics);
}

}  // namespace

TEST_CASE("spreading in Luneburg's ball: agrees with the closed form, through caustics") {
  check_harmonic<Sharma>(1200, 1e-6);
  check_harmonic<Yoshida4>(2400, 1e-6);
  check_harmonic<Leapfrog>(12000, 1e-4);
}

TEST_CASE("spreading in a fisheye: agrees with the closed form, through foci") {
  const Fisheye field({.centre_excess = 0.7, .radius = 0.8});
  const double radius = 1.7 * 0.8 / 2;
  RandomStream random(62, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const RayState start = start_ray(field, random_point(random, 1), random_direction(random));
    const Traced ray = traced<Sharma>(field, start, 3 * random.uniform(), 3000);
    const double angle = ray.end.optical_path / radius;
    const double n_end = index(field, ray.end.x);
    const double exact = std::pow(radius * std::sin(angle) / n_end, 2);
    CAPTURE(angle);
    CHECK(ray.spreading == doctest::Approx(exact).epsilon(1e-6).scale(0));
    // both widths go through 0 at once, at every multiple of pi
    CHECK(ray.caustics == 2 * static_cast<int>(angle / pi));
  }
}

TEST_CASE("spreading after a quarter pitch of a guide: (2/pi)^2 times the length squared") {
  const ParabolicGuide guide({.axis_excess = 0.5, .alpha = 0.3});
  const RayState start = start_ray(guide, Vec3::Zero(), Vec3::UnitZ());
  const Traced ray = traced<Sharma>(guide, start, pi / (2 * 0.3), 200);
  CHECK(ray.end.arc_length == doctest::Approx(1.5 * pi / 0.6).epsilon(1e-9));
  CHECK(ray.spreading == doctest::Approx(std::pow(2 / pi * ray.end.arc_length, 2)).epsilon(1e-6));
}

TEST_CASE("caustics in Luneburg's ball: line foci count once, point foci twice") {
  const HarmonicBall field{{}};
  RandomStream random(63, 0, 0);
  for (int i = 0; i < 200; ++i) {
    const RayState start = start_ray(field, random_point(random, 1), random_direction(random));
    const double sigma = 3 * pi * random.uniform();
    // v0.v = |v0|^2 cos - v0.x0 sin changes sign once every pi
    const double line = std::atan2(start.v.squaredNorm(), start.v.dot(start.x));  // in (0, pi)
    const double since_point = std::remainder(sigma, pi);
    const double since_line = std::remainder(sigma - line, pi);
    // coarse steps move the foci a little, and leave the ball where the index is near 0
    if (std::min(std::abs(since_point), std::abs(since_line)) < 0.02) continue;
    if (start.x.cross(start.v).norm() < 0.6) continue;
    CAPTURE(sigma);
    CAPTURE(line);
    const int expected =
        2 * static_cast<int>(sigma / pi) + static_cast<int>(std::floor((sigma - line) / pi) + 1);
    for (const int steps : {60, 1000})
      CHECK(traced<Yoshida4>(field, start, sigma, steps).caustics == expected);
  }
}

TEST_CASE("spreading: reciprocal, n_P^2 / |J_PQ| = n_Q^2 / |J_QP|") {
  for (int i = 0; i < 50; ++i) {
    RandomStream random(64, 0, i);
    check_reciprocal(bench::random_blobs(random, 0.3), random, 400);
    check_reciprocal(bench::random_spline(random, 0.1), random, 1600);
  }
}

TEST_CASE("start directions: samples agree with their density") {
  const StartDirections start{.chord_share = 0.4, .cosine = 0.8};
  const Vec3 chord = Vec3(1, -2, 0.5).normalized();
  RandomStream random(65, 0, 0);
  const int count = 200000;
  int in_cone = 0;
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < count; ++i) {
    const Vec3 direction = start.sample(chord, random);
    CHECK(direction.norm() == doctest::Approx(1).epsilon(1e-14));
    in_cone += direction.dot(chord) > 0.8;
    sum += direction;
  }
  const double share = 2 * pi * 0.2 * start.density(0.9);
  CHECK(share + 2 * pi * 1.8 * start.density(0) == doctest::Approx(1).epsilon(1e-14));
  CHECK(std::abs(in_cone / double(count) - share) < 4 * std::sqrt(share * (1 - share) / count));
  // the mean direction: (share of the cone) (1 + cosine) / 2 along the chord
  CHECK((sum / count - 0.4 * 0.9 * chord).norm() < 5 / std::sqrt(count));
}

}  // namespace flatspeckle::grin::test_spreading
