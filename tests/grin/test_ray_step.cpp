#include <cmath>

#include <doctest/doctest.h>

#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/sech.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/media/fields/ultrasound.h"
#include "grin/rays/marching/ray_invariants.h"
#include "tests/grin/derivatives.h"
#include "tests/grin/ray_tests.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_ray_step {

using tests::go;
using tests::pi;

#define INTEGRATORS Leapfrog, Yoshida4, Sharma

namespace {

const Luneburg lens{LuneburgProfile{1}};
const Vec3 inside{-0.6, 0.3, 0.2};

/// Errors of position, direction, optical path and arc length after sigma = 1.1.
template <class Integrator>
Eigen::Array4d luneburg_errors(int steps) {
  const RayState start = start_ray(lens, inside, {0.8, 0.5, -0.3});
  const tests::LuneburgRay exact{start.x, start.v};
  const auto speed = [&](double s) { return index(lens, exact.x(s)); };
  const double sigma = 1.1;
  RayState ray = start;
  go<Integrator>(lens, sigma, steps, ray);
  Eigen::Array4d errors;
  errors << (ray.x - exact.x(sigma)).norm(), (ray.v - exact.v(sigma)).norm(),
      ray.optical_path - exact.optical_path(sigma),
      ray.arc_length - flatspeckle::tests::integral(speed, 0, sigma);
  return errors.abs();
}

/// Checks the derivatives of the final position and ray vector by v0 against extrapolated
/// differences.
template <class Integrator, IndexField F>
void check_tangent(const F& field, const RayState& start, double sigma, int steps) {
  RayState ray = start;
  RayTangent tangent;
  go<Integrator>(field, sigma, steps, ray, tangent);
  RayState alone = start;
  go<Integrator>(field, sigma, steps, alone);
  CHECK((alone.x - ray.x).norm() + (alone.v - ray.v).norm() < 1e-14);
  CHECK(std::abs(alone.optical_path - ray.optical_path) < 1e-14);
  const auto end = [&](const Vec3& v0) {
    RayState state = start;
    state.v = v0;
    go<Integrator>(field, sigma, steps, state);
    Eigen::Matrix<double, 6, 1> both;
    both << state.x, state.v;
    return both;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto d = tests::derivative(end, start.v, axis, 0.02);
    CHECK((d.head(3) - tangent.dx.col(axis)).norm() < 1e-8 * tangent.dx.norm());
    CHECK((d.tail(3) - tangent.dv.col(axis)).norm() < 1e-8 * tangent.dv.norm());
  }
}

}  // namespace

TEST_CASE_TEMPLATE("ray steps: all that they accumulate converges with their order", I,
                   INTEGRATORS) {
  const auto coarse = luneburg_errors<I>(64), fine = luneburg_errors<I>(128);
  for (int i = 0; i < 4; ++i) {
    CAPTURE(i);
    CAPTURE(fine[i]);
    CHECK(std::abs(std::log2(coarse[i] / fine[i]) - I::order) < 0.1);
  }
}

TEST_CASE_TEMPLATE("ray steps: the tangent agrees with the derivative of the discrete ray", I,
                   INTEGRATORS) {
  // Steps so coarse that the discrete ray is far from the continuous one.
  check_tangent<I>(lens, start_ray(lens, inside, {0.8, 0.5, -0.3}), 1.1, 4);
  const Fisheye eye(FisheyeProfile{1, 1});
  check_tangent<I>(eye, start_ray(eye, inside, {0.8, 0.5, -0.3}), 0.9, 5);
  const SechGuide guide(SechProfile{0.5, 1});
  check_tangent<I>(guide, start_ray(guide, inside, {0.3, -0.2, 1}), 2, 6);
  const StandingWave wave(0.33, 0.05, 2, 5, 2);
  check_tangent<I>(wave, start_ray(wave, inside, {0.3, -0.2, 1}), 1, 8);
  const SplineField spline = tests::random_spline(3);
  check_tangent<I>(spline, start_ray(spline, {1.2, 1.1, 1.3}, {0.1, 0.2, 0.3}), 0.15, 3);
  const Homogeneous plain{0.5};
  check_tangent<I>(plain, start_ray(plain, inside, {0.3, -0.2, 1}), 1, 3);
}

TEST_CASE_TEMPLATE("ray steps: straight in a homogeneous medium", I, INTEGRATORS) {
  const Homogeneous plain{0.5};
  RayState ray = start_ray(plain, {1, 2, 3}, {0, 3, 4});
  I::step(plain, ray, 2);
  CHECK((ray.x - Vec3(1, 2 + 1.8, 3 + 2.4)).norm() < 1e-15);
  CHECK((ray.v - Vec3(0, 0.9, 1.2)).norm() < 1e-15);
  CHECK(ray.arc_length == doctest::Approx(3));
  CHECK(ray.optical_path == doctest::Approx(4.5));
}

TEST_CASE_TEMPLATE("symplectic steps: reversible", I, Leapfrog, Yoshida4) {
  const RayState start = start_ray(lens, inside, {0.8, 0.5, -0.3});
  RayState ray = start;
  go<I>(lens, 1, 20, ray);
  go<I>(lens, -1, 20, ray);
  CHECK((ray.x - start.x).norm() < 1e-14);
  CHECK((ray.v - start.v).norm() < 1e-14);
  CHECK(std::abs(ray.optical_path) < 1e-14);
}

TEST_CASE("Luneburg lens: a collimated beam is focused on the far rim, in phase") {
  for (const double height : {0.0, 0.3, 0.9, 0.999}) {
    const Vec3 x(-std::sqrt(1 - height * height), height * 0.6, height * 0.8);
    RayState ray = start_ray(lens, x, Vec3::UnitX());
    go<Sharma>(lens, pi / 2, 400, ray);
    CHECK((ray.x - Vec3::UnitX()).norm() < 1e-10);
    CHECK((x[0] + 1) + ray.optical_path == doctest::Approx(pi / 2 + 1).epsilon(1e-9));
    CHECK(std::abs(ray_invariants(lens, ray).index_mismatch) < 1e-9);
    CHECK((ray_invariants(lens, ray).angular_momentum - x.cross(Vec3::UnitX())).norm() < 1e-10);
  }
}

TEST_CASE("parabolic guide: rays agree with sinusoids in sigma and keep their invariants") {
  const double n0 = 1.5, alpha = 0.7;
  const ParabolicGuide guide(ParabolicProfile{n0 - 1, alpha});
  RayState ray = start_ray(guide, {0.4, -0.2, 0}, {0.2, 0.3, 1});
  const RayState start = ray;
  const RayInvariants first = ray_invariants(guide, start);
  const double sigma = 7.3, c = std::cos(alpha * sigma), s = std::sin(alpha * sigma);
  go<Yoshida4>(guide, sigma, 2000, ray);
  const Vec3 exact = c * start.x + s / alpha * start.v;
  CHECK((ray.x - Vec3(exact[0], exact[1], start.v[2] * sigma)).norm() < 1e-9);
  const RayInvariants last = ray_invariants(guide, ray);
  CHECK(std::abs(last.axial_momentum - first.axial_momentum) < 1e-14);
  CHECK(std::abs(last.axial_rotation - first.axial_rotation) < 1e-13);
  CHECK(std::abs(last.index_mismatch) < 1e-10);
}

TEST_CASE("parabolic guide: errors stay bounded over 1000 periods of 40 steps") {
  const ParabolicGuide guide(ParabolicProfile{0.5, 1});
  const auto mismatch = []<class I>(const ParabolicGuide& field, I, int periods) {
    RayState ray = start_ray(field, {0.5, 0, 0}, {0.1, 0.3, 1});
    const RayInvariants first = ray_invariants(field, ray);
    double worst = 0;
    for (int i = 0; i < 40 * periods; ++i) {
      I::step(field, ray, 2 * pi / 40);
      worst = std::max(worst, std::abs(ray_invariants(field, ray).index_mismatch));
    }
    CHECK(ray_invariants(field, ray).axial_momentum == first.axial_momentum);
    CHECK(std::abs(ray_invariants(field, ray).axial_rotation - first.axial_rotation) < 1e-6);
    return worst;
  };
  CHECK(mismatch(guide, Leapfrog{}, 1000) < 2e-3);
  CHECK(mismatch(guide, Yoshida4{}, 1000) < 2e-5);
  CHECK(mismatch(guide, Yoshida4{}, 10000) < 2e-5);  // it does not grow
}

TEST_CASE("parabolic guide of index 1 + 1e-6: rays agree with the closed form") {
  // Period 2 pi beta / alpha = 2 pi 1e4; amplitude 0.3. The optical path beyond the length is 1e-7
  // of it.
  const ParabolicGuide guide(ParabolicProfile{1e-6, 1e-4});
  RayState ray = start_ray(guide, {0.3, 0, 0}, Vec3::UnitZ());
  const double beta = ray.v[2], sigma = 2 * pi / 1e-4;
  go<Yoshida4>(guide, 1.25 * sigma, 1000, ray);
  CHECK(std::abs(ray.x[0]) < 1e-8);
  CHECK(ray.v[0] == doctest::Approx(-0.3e-4).epsilon(1e-9));
  CHECK(std::abs(ray_invariants(guide, ray).index_mismatch) < 1e-15);
  const double n0 = 1 + 1e-6, z = beta * 1.25 * sigma;
  CHECK(ray.optical_path ==
        doctest::Approx(z * (n0 * n0 + beta * beta) / (2 * beta)).epsilon(1e-14));
}

TEST_CASE_TEMPLATE("layers: n sin(angle to the normal) is constant", I, INTEGRATORS) {
  const TanhRamp ramp{0.5, 0.1, 0.3};
  RayState ray = start_ray(ramp, {0, 0, -2}, {1, 0.5, 2});
  const Vec3 first = ray_invariants(ramp, ray).transverse;
  go<I>(ramp, 4, 60, ray);
  CHECK((ray_invariants(ramp, ray).transverse - first).norm() < 1e-14);
}

}  // namespace flatspeckle::grin::test_ray_step
