#include <cmath>

#include <doctest/doctest.h>
#include <omp.h>

#include "core/numbers/bessel.h"
#include "core/numbers/fourier.h"
#include "core/numbers/random.h"
#include "reference.h"
#include "tests/statistics.h"
#include "wave_solver/sums/grid_sum.h"
#include "wave_solver/sums/helmholtz_sum.h"

namespace flatspeckle::wave::test_helmholtz_sum {

namespace {

std::vector<Vec> points_in_box(std::size_t count, double width, double depth,
                               std::uint64_t seed = 1) {
  RandomStream random(seed, 1, count);
  std::vector<Vec> points(count);
  for (Vec& p : points) p = {width * (random.uniform() - 0.5), depth * random.uniform()};
  return points;
}

std::vector<Vec> points_in_space(std::size_t count, Vec size) {
  RandomStream random(7, 1, count);
  std::vector<Vec> points(count);
  for (Vec& p : points)
    p = {size.x * random.uniform(), size.z * random.uniform(), size.y * random.uniform()};
  return points;
}

std::vector<Complex> random_charges(std::size_t count) {
  RandomStream random(5, 2, count);
  std::vector<Complex> charges(count);
  for (Complex& q : charges) q = {random.uniform() - 0.5, random.uniform() - 0.5};
  return charges;
}

// Reference: the sum over all pairs with accurate Hankel functions.
std::vector<Complex> direct_sum(double k, const std::vector<Vec>& sources,
                                const std::vector<Vec>& targets,
                                const std::vector<Complex>& charges,
                                Radial kind = Radial::cylindrical) {
  const std::size_t columns = charges.size() / sources.size();
  std::vector<Complex> sums(columns * targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i)
    for (std::size_t j = 0; j < sources.size(); ++j) {
      const double r = length(targets[i] - sources[j]);
      if (r == 0) continue;
      const Complex h = kind == Radial::cylindrical ? Complex(hankel(0, k * r)[0])
                                                    : std::polar(1 / (k * r), k * r - two_pi / 4);
      for (std::size_t c = 0; c < columns; ++c)
        sums[c * targets.size() + i] += h * charges[c * sources.size() + j];
    }
  return sums;
}

const std::size_t some = flatspeckle::tests::is_night ? 1500 : 900;
constexpr double tolerances[] = {1e-3, 1e-6, 1e-9, 1e-12};

void check_accuracy(double k, const std::vector<Vec>& points) {
  const auto charges = random_charges(points.size());
  const auto exact = direct_sum(k, points, points, charges);
  for (const double tolerance : tolerances) {
    CAPTURE(tolerance);
    const HelmholtzSum sum(k, points, tolerance);
    CHECK(sum.range() > 0);
    CHECK(relative_distance(sum(charges), exact) < tolerance);
  }
}

// Checks sums in space with two columns of charges and a given range.
void check_in_space(const std::vector<Vec>& points, double range) {
  const auto charges = random_charges(2 * points.size());
  const auto exact = direct_sum(two_pi, points, points, charges, Radial::spherical);
  for (const double tolerance : tolerances) {
    CAPTURE(tolerance);
    const HelmholtzSum sum(two_pi, points, tolerance, Radial::spherical, range);
    CHECK(relative_distance(sum(charges), exact) < tolerance);
  }
}

}  // namespace

TEST_CASE("kernel split: near and far parts add to H_0, and near vanishes beyond its range") {
  for (const double range : {1e-3, 0.3, 2.0, 30.0})
    for (const double tolerance : tolerances) {
      const KernelSplit split(two_pi, range, tolerance);
      CHECK(split.band() > two_pi);
      const std::vector<double> distances{1e-6 * range,  0.1 * range,   0.7 * range,
                                          0.999 * range, 1.001 * range, 5 * range};
      std::vector<double> near(distances.size());
      std::vector<Complex> far(distances.size());
      split.near(distances, near);
      split.far(distances, far);
      for (std::size_t i = 0; i < near.size(); ++i) {
        const Complex exact = Complex(hankel(0, two_pi * distances[i])[0]);
        CHECK(std::abs(far[i] + Complex(0, near[i]) - exact) < 1e-13 * std::abs(exact));
      }
      CHECK(std::abs(near[3]) < 1e-7);
      CHECK(near[4] == 0);
    }
}

// far is H_0 convolved with a mollifier, so that (Laplacian + k^2) far is the mollifier: not 0
// within the range, smooth at it, and 0 beyond.
TEST_CASE(
    "kernel split: the far part satisfies the wave equation beyond the range and is smooth at it") {
  const double k = two_pi, range = 0.8, step = 1e-3;
  const KernelSplit split(k, range, 1e-10);
  const auto source = [&](double r) {
    const std::vector<double> at{r - step, r, r + step};
    std::vector<Complex> u(3);
    split.far(at, u);
    return std::abs((u[2] - 2.0 * u[1] + u[0]) / (step * step) + (u[2] - u[0]) / (2 * step * r) +
                    k * k * u[1]);
  };
  CHECK(source(1.1 * range) < 1e-3);
  CHECK(source(range) < 1e-3);
  CHECK(source(0.05 * range) > 1);
}

TEST_CASE("Helmholtz sum: agrees with the direct sum within the tolerance in boxes of all shapes") {
  for (const Vec box :
       {Vec{12, 12}, {40, 3}, {0.02, 60}, {70, 70}, {1, 1}, {1e-3, 1e-3}, {1e-5, 2e-7}}) {
    CAPTURE(box.x);
    check_accuracy(two_pi, points_in_box(some, box.x, box.z));
  }
}

TEST_CASE("kernel split in space: parts add to h_0, and near vanishes beyond its range") {
  for (const double range : {1e-3, 0.5, 3.0}) {
    const KernelSplit split(two_pi, range, 1e-9, Radial::spherical);
    const std::vector<double> distances{1e-6 * range, 0.1 * range, 0.999 * range, 1.001 * range};
    std::vector<double> near(distances.size());
    std::vector<Complex> far(distances.size());
    split.near(distances, near);
    split.far(distances, far);
    for (std::size_t i = 0; i < near.size(); ++i) {
      const double x = two_pi * distances[i];
      CHECK(std::abs(far[i] + Complex(0, near[i]) - std::polar(1 / x, x - two_pi / 4)) < 1e-13 / x);
    }
    CHECK(std::abs(near[2]) < 1e-6 / (two_pi * range));
    CHECK(near[3] == 0);
  }
}

TEST_CASE("Helmholtz sum in space: agrees with the direct sum within the tolerance") {
  check_in_space(points_in_space(400, {2, 1.2, 0.7}), 0.5);
  check_in_space(points_in_space(400, {2, 0, 1}), 0.3);
  auto close = points_in_space(400, {1, 1, 1});
  for (std::size_t i = 0; i < 20; ++i) {
    close[100 + i] = close[i] + Vec{0, 0, 1e-6};
    close[200 + i] = close[i];
  }
  check_in_space(close, 0.4);
}

TEST_CASE("Helmholtz sum in space: uses a grid for dense points only") {
  const auto dense = points_in_space(20000, {8, 8, 8});
  CHECK(HelmholtzSum(two_pi, dense, 1e-4, Radial::spherical).range() > 0);
  const auto sparse = points_in_space(2000, {30, 30, 30});
  CHECK(HelmholtzSum(two_pi, sparse, 1e-4, Radial::spherical).range() == 0);
}

TEST_CASE("Helmholtz sum: is invariant under a change of the unit of length") {
  const auto points = points_in_box(1200, 10, 10);
  std::vector<Vec> larger;
  for (const Vec p : points) larger.push_back(1e4 * p);
  const auto charges = random_charges(points.size());
  CHECK(relative_distance(HelmholtzSum(two_pi * 1e-4, larger, 1e-9)(charges),
                          HelmholtzSum(two_pi, points, 1e-9)(charges)) < 1e-9);
}

TEST_CASE("Helmholtz sum: close points are summed accurately, coincident ones omitted") {
  auto points = points_in_box(1500, 12, 12);
  for (std::size_t i = 0; i < 50; ++i) {
    points[100 + i] = points[i] + Vec{1e-6, 0};
    points[200 + i] = points[i] + Vec{0, -1e-10};
    points[300 + i] = points[i];
  }
  check_accuracy(two_pi, points);
}

TEST_CASE("Helmholtz sum: points on a line, clustered, and at the corners of the box") {
  check_accuracy(two_pi, points_in_box(some, 0, 50));
  check_accuracy(two_pi, points_in_box(some, 50, 0));
  auto clustered = points_in_box(some, 20, 20);
  for (std::size_t i = 0; i < some / 3; ++i) clustered[i] = 1e-3 * clustered[i];
  for (const Vec corner : {Vec{-10, 0}, {10, 0}, {-10, 20}, {10, 20}}) clustered.push_back(corner);
  check_accuracy(two_pi, clustered);
}

TEST_CASE("Helmholtz sum: no, one, two and coincident points") {
  CHECK(HelmholtzSum(two_pi, {}, 1e-9)({}).empty());
  const std::vector<Vec> pair{{0, 0}, {0.3, 0.4}};
  CHECK(HelmholtzSum(two_pi, std::span(pair).first(1), 1e-9)(random_charges(1))[0] == Complex());
  const auto charges = random_charges(2);
  CHECK(relative_distance(HelmholtzSum(two_pi, pair, 1e-9)(charges),
                          direct_sum(two_pi, pair, pair, charges)) < 1e-14);
  const std::vector<Vec> same(3, Vec{1, 1});
  for (const Complex u : HelmholtzSum(two_pi, same, 1e-9)(random_charges(3))) CHECK(u == Complex());
}

TEST_CASE("Helmholtz sum: few points far apart are summed directly") {
  const auto points = points_in_box(300, 1e6, 1e6);
  const HelmholtzSum sum(two_pi, points, 1e-12);
  CHECK(sum.range() == 0);
  const auto charges = random_charges(points.size());
  CHECK(relative_distance(sum(charges), direct_sum(two_pi, points, points, charges)) < 1e-13);
}

TEST_CASE("Helmholtz sum: separate targets and several columns agree with the direct sum") {
  auto sources = points_in_box(1200, 12, 12), targets = points_in_box(2500, 6, 25, 2);
  targets[7] = sources[3];
  const auto charges = random_charges(3 * sources.size());
  const auto exact = direct_sum(two_pi, sources, targets, charges);
  for (const double tolerance : tolerances) {
    const HelmholtzSum sum(two_pi, sources, targets, tolerance);
    CHECK(sum.range() > 0);
    CHECK(relative_distance(sum(charges), exact) < tolerance);
  }
  CHECK(HelmholtzSum(two_pi, sources, {}, 1e-6)(charges).empty());
}

TEST_CASE("Helmholtz sum: results do not depend on the number of threads") {
  const auto points = points_in_box(3000, 17, 17);
  const auto charges = random_charges(2 * points.size());
  const int threads = omp_get_max_threads();
  std::vector<std::vector<Complex>> sums;
  for (const int count : {1, 2, 3, 7}) {
    omp_set_num_threads(count);
    sums.push_back(HelmholtzSum(two_pi, points, 1e-9)(charges));
  }
  omp_set_num_threads(threads);
  const HelmholtzSum sum(two_pi, points, 1e-9);
  std::vector<std::vector<Complex>> inside(2);
#pragma omp parallel for num_threads(2)
  for (std::size_t i = 0; i < 2; ++i) inside[i] = sum(charges);
  sums.insert(sums.end(), inside.begin(), inside.end());
  for (const auto& other : sums) CHECK(other == sums[0]);
}

TEST_CASE("transform size: is the next even product of 2, 3 and 5") {
  const auto smooth = [](std::size_t n) {
    for (const std::size_t prime : {2, 3, 5})
      while (n % prime == 0) n /= prime;
    return n == 1;
  };
  for (std::size_t least = 1; least < 5000; ++least) {
    std::size_t next = least + least % 2;
    while (!smooth(next)) next += 2;
    REQUIRE(transform_size(static_cast<double>(least)) == next);
  }
  for (const double least : {1e12, 1e17})  // without a long search
    CHECK(static_cast<double>(transform_size(least)) < 1.01 * least);
  CHECK(smooth(transform_size(1e50)));
}

}  // namespace flatspeckle::wave::test_helmholtz_sum
