#include <cmath>
#include <numbers>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/media/hard_sphere_fluid.h"
#include "flatland/media/medium.h"

namespace flatspeckle::test_hard_spheres {

namespace {

using std::numbers::pi;

/// Integrates over [0, last] in panels of length 1.
template <typename F>
double integral(double last, const F& f) {
  double sum = 0;
  for (double from = 0; from < last; ++from)
    sum += boost::math::quadrature::gauss_kronrod<double, 15>::integrate(f, from, from + 1, 0);
  return sum;
}

/// Returns the integral of exp(i q.r) over a ball.
double ball_transform(double radius, double q) {
  const double x = q * radius, cube = std::pow(radius, 3);
  if (x < 1e-2) return 4 * pi / 3 * cube * (1 - x * x / 10);
  return 4 * pi * cube * (std::sin(x) - x * std::cos(x)) / (x * x * x);
}

}  // namespace

TEST_CASE("hard spheres: S(0) has its closed form, S tends to 1 at large q") {
  for (const double packing : {0.0, 1e-3, 0.1, 0.3, 0.49}) {
    const HardSphereFluid fluid(packing, 1.7);
    const double free = 1 - packing, full = 1 + 2 * packing;
    CHECK(fluid.structure_factor(0) ==
          doctest::Approx(std::pow(free, 4) / (full * full)).epsilon(1e-13));
    CHECK(std::abs(fluid.structure_factor(1000) - 1) < 1e-4);
  }
}

TEST_CASE("hard spheres: a dilute suspension has S = 1 - 8 phi 3 (sin x - x cos x) / x^3") {
  constexpr double packing = 1e-5, diameter = 2;
  const HardSphereFluid fluid(packing, diameter);
  CHECK((fluid.structure_factor(0) - 1) / packing == doctest::Approx(-8).epsilon(1e-4));
  for (const double x : {0.3, 1.0, 3.0, 8.0, 20.0}) {
    const double overlap = 3 * (std::sin(x) - x * std::cos(x)) / (x * x * x);
    CHECK(std::abs((fluid.structure_factor(x / diameter) - 1) / packing + 8 * overlap) < 2e-3);
  }
}

// In the Percus-Yevick solution no two centres are closer than the diameter. A ball of a smaller
// diameter therefore contains at most one centre, so that the variance of the number of centres in
// it is n (1 - n), n its mean. By the Fourier transform B of the ball, this variance is
// rho int S B^2 d^3q / (2 pi)^3.
TEST_CASE("hard spheres: spheres of the Percus-Yevick fluid do not overlap") {
  for (const double packing : {0.05, 0.2, 0.4, 0.49}) {
    const HardSphereFluid fluid(packing, 1);
    const double density = 6 * packing / pi;
    for (const double radius : {0.3, 0.4, 0.5}) {
      CAPTURE(packing);
      CAPTURE(radius);
      const double mean = density * ball_transform(radius, 0);
      const double of_structure = density / (2 * pi * pi) * integral(400, [&](double q) {
                                    const double ball = ball_transform(radius, q);
                                    return (fluid.structure_factor(q) - 1) * ball * ball * q * q;
                                  });
      CHECK(of_structure == doctest::Approx(-mean * mean).epsilon(1e-6));
    }
    // A ball wider than the diameter contains two centres at times.
    const double mean = density * ball_transform(0.6, 0);
    const double wide = density / (2 * pi * pi) * integral(400, [&](double q) {
                          const double ball = ball_transform(0.6, q);
                          return (fluid.structure_factor(q) - 1) * ball * ball * q * q;
                        });
    CHECK(wide > -0.999 * mean * mean);
  }
}

TEST_CASE("hard spheres: S is continuous where its series ends, and depends on q times diameter") {
  const HardSphereFluid one(0.4, 1), three(0.4, 3);
  CHECK(one.structure_factor(2 - 1e-9) ==
        doctest::Approx(one.structure_factor(2 + 1e-9)).epsilon(1e-8));
  for (const double q : {1e-5, 0.5, 5.6, 30.0})
    CHECK(three.structure_factor(q) == doctest::Approx(one.structure_factor(3 * q)).epsilon(1e-12));
}

TEST_CASE("hard spheres: a suspension that would freeze is rejected") {
  const double dense = 0.5 * 6 / pi;
  CHECK_THROWS_WITH_AS(hard_sphere_structure(dense, 1), doctest::Contains("at most 0.49"),
                       InputError);
  const StructureFactor fluid = hard_sphere_structure(0.4 * 6 / pi, 1);
  CHECK_FALSE(fluid.independent());
  CHECK_NOTHROW(hard_sphere_structure((1 + 1e-15) * 0.49 * 6 / pi, 1));
  CHECK(fluid(7) == doctest::Approx(HardSphereFluid(0.4, 1).structure_factor(7)).epsilon(1e-12));
  CHECK(fluid.text() != hard_sphere_structure(0.4 * 6 / pi, 1 + 1e-14).text());
}

}  // namespace flatspeckle::test_hard_spheres
