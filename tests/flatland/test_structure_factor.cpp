#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "flatland/media/structure_factor.h"
#include "periodic_disks.h"

namespace flatspeckle::test_structure_factor {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

std::vector<Vec> uniform_points(const Domain& box, std::size_t number, RandomStream& random) {
  std::vector<Vec> points;
  while (points.size() < number) {
    const double x = (random.uniform() - 0.5) * box.width;
    points.push_back({x, random.uniform() * box.depth});
  }
  return points;
}

/// Returns |sum exp(i q.r)|^2 / N of one wavevector.
double single(const Domain& box, const std::vector<Vec>& points, int n, int m) {
  std::complex<double> sum;
  for (const Vec& r : points)
    sum += std::polar(1.0, two_pi * (n * r.x / box.width + m * r.z / box.depth));
  return std::norm(sum) / static_cast<double>(points.size());
}

}  // namespace

TEST_CASE("structure factor: S(0) agrees with the compressibility of the equation of state") {
  for (const double packing : {0.01, 0.2, 0.45, 0.69}) {
    const double step = 1e-5;
    const auto pressure = [](double eta) { return eta * tests::compressibility_factor(eta); };
    const double stiffness = (pressure(packing + step) - pressure(packing - step)) / (2 * step);
    // This tests the two integrals of c(r) and Baus and Colot's equation for their length.
    CHECK(HardDiskFluid(packing, 2.5).structure_factor(0) ==
          doctest::Approx(1 / stiffness).epsilon(1e-5));
  }
  CHECK(tests::compressibility_factor(0.5) == doctest::Approx(4.125));
}

TEST_CASE("structure factor: a dilute gas has S = 1 - 8 eta J_1(x) / x; S tends to 1 at large q") {
  const HardDiskFluid thin(1e-4, 2), none(0, 1);
  for (const double q : {0.3, 1.0, 2.5, 7.0})
    CHECK(thin.structure_factor(q) - 1 ==
          doctest::Approx(-8e-4 * ::j1(2 * q) / (2 * q)).epsilon(2e-3));
  CHECK(none.structure_factor(1.5) == 1);
  for (const double packing : {0.1, 0.4, 0.65})
    CHECK(std::abs(HardDiskFluid(packing, 1).structure_factor(400) - 1) < 0.01);
}

TEST_CASE("structure factor: depends on q times the diameter and is continuous") {
  const HardDiskFluid one(0.5, 1), three(0.5, 3);
  for (const double q : {1e-5, 0.5, 5.6, 30.0})
    CHECK(three.structure_factor(q) == doctest::Approx(one.structure_factor(3 * q)).epsilon(1e-12));
  CHECK(one.structure_factor(0.99e-4) == doctest::Approx(one.structure_factor(1.01e-4)));
  for (double q = 0.1; q < 40; q += 0.37)
    CHECK(std::abs(one.structure_factor(q + 1e-6) - one.structure_factor(q)) < 2e-5);
}

TEST_CASE("measured structure factor: agrees with sums over single wavevectors") {
  const Domain box{Domain::Kind::box, 7, 4};
  RandomStream random(2, 1, 0);
  const auto points = uniform_points(box, 23, random);
  constexpr double q_max = 9, width = 1.5;
  MeasuredStructureFactor measured(box, q_max, width);
  measured.add(points);
  std::vector<double> sums(6), members(6), q_sums(6);
  for (int n = -12; n <= 12; ++n)  // the whole plane
    for (int m = -12; m <= 12; ++m) {
      const double q = two_pi * std::hypot(n / box.width, m / box.depth);
      if (q > q_max || (n == 0 && m == 0)) continue;
      const auto shell = static_cast<std::size_t>(q / width);
      sums[shell] += single(box, points, n, m), members[shell] += 1, q_sums[shell] += q;
    }
  REQUIRE(*std::min_element(members.begin(), members.end()) > 0);
  const auto values = measured.values();
  const auto q = measured.shell_means([](double k) { return k; });
  REQUIRE(values.size() == 6);
  for (std::size_t shell = 0; shell < 6; ++shell) {
    CHECK(values[shell] == doctest::Approx(sums[shell] / members[shell]).epsilon(1e-12));
    CHECK(q[shell] == doctest::Approx(q_sums[shell] / members[shell]).epsilon(1e-12));
  }
}

TEST_CASE("measured structure factor: independent points have S = 1, with correct errors") {
  const Domain box{Domain::Kind::box, 20, 10};
  MeasuredStructureFactor measured(box, 12, 0.125);
  RandomStream random(4, 1, 0);
  for (int r = 0; r < 400; ++r) measured.add(uniform_points(box, 50, random));
  const auto values = measured.values(), errors = measured.errors();
  double squares = 0;
  for (std::size_t shell = 0; shell < values.size(); ++shell) {
    const double deviation = (values[shell] - 1) / errors[shell];
    CHECK(std::abs(deviation) < 4);
    squares += deviation * deviation;
  }
  // The mean square is 1 with a standard error of sqrt(2 / shells).
  const auto shells = static_cast<double>(values.size());
  CHECK(shells > 80);
  CHECK(std::abs(squares / shells - 1) < 4 * std::sqrt(2 / shells));
}

}  // namespace flatspeckle::test_structure_factor
