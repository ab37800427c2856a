#include <cmath>
#include <string>

#include <doctest/doctest.h>
#include <omp.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "reference.h"
#include "tests/statistics.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/skeletons/fast_direct.h"

namespace flatspeckle::wave::test_fast_direct {

namespace {

// Adds scatterers at random positions, separated by at least a gap.
void scatter(Placement& placement, std::size_t count, Vec size, const Scatterer& scatterer,
             double gap) {
  RandomStream random(12, 1, count);
  while (count > 0) {
    const Vec centre{size.x * random.uniform(), size.z * random.uniform()};
    bool fits = true;
    for (const auto& other : placement)
      fits =
          fits && length(other.position - centre) > scatterer.radius + other.scatterer.radius + gap;
    if (!fits) continue;
    placement.push_back({centre, scatterer});
    --count;
  }
}

Placement scattered(std::size_t count, Vec size, const Scatterer& scatterer, double gap = 0) {
  Placement placement;
  scatter(placement, count, size, scatterer, gap);
  return placement;
}

Scatterer disk(const std::string& kind, double radius) {
  Scatterer scatterer = reference_scatterer(kind);
  scatterer.radius = radius;
  return scatterer;
}

Scatterer weak_point() {
  Scatterer point;
  point.phase_shift = 0.3;
  return point;
}

std::vector<Complex> times(const Entries& matrix, const std::vector<Complex>& x, std::size_t n) {
  std::vector<Complex> y(x.size());
  for (std::size_t start = 0; start < x.size(); start += n)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) y[start + i] += product(matrix[j * n + i], x[start + j]);
  return y;
}

// Compares solutions with dense ones, and residuals computed with M itself. M is replaced by a
// matrix that differs by about the tolerance in norm. Residuals are below 3 tolerances, plus an
// error of unpivoted elimination up to 1e-9 that depends on the rounding of the BLAS. Errors are
// below `worse` tolerances, a factor that increases with the condition number.
void check_accuracy(const Placement& placement, double worse, bool compresses = true) {
  const TMatrixSystem system(placement, two_pi, 1e-5);
  const std::vector<double> lights{0.3, 2};
  const auto rhs = system.right_hand_sides(lights);
  const auto matrix = system.matrix();
  const auto exact = DenseFactor(matrix, system.unknowns()).solve(rhs);
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    if (!flatspeckle::tests::is_night && (tolerance == 1e-3 || tolerance == 1e-9)) continue;
    const FastDirect direct(system, tolerance);
    auto x = rhs;
    direct.solve(x);
    CAPTURE(tolerance);
    const double floor = tolerance < 1e-9 ? 1e-8 : 1e-10;
    CHECK(relative_distance(times(matrix, x, system.unknowns()), rhs) < 3 * tolerance + floor);
    CHECK(relative_distance(x, exact) < worse * (tolerance + floor));
    if (compresses) CHECK(direct.statistics().root < system.unknowns() / 2);
  }
}

}  // namespace

TEST_CASE("fast direct: points agree with the dense solution") {
  check_accuracy(scattered(1500, {12.2, 12.2}, Scatterer{}), 30);
  check_accuracy(scattered(1500, {12.2, 12.2}, weak_point()), 30);
}

TEST_CASE("fast direct: cylinders agree with the dense solution") {
  check_accuracy(scattered(120, {8, 8}, disk("TM15", 0.2), 0.1), 10);
  check_accuracy(scattered(120, {8, 8}, disk("TE15", 0.2), 0.1), 10);
  check_accuracy(scattered(120, {8, 8}, disk("D", 0.2), 0.1), 30);
  check_accuracy(scattered(12, {9, 9}, disk("TM15abs", 0.9), 0.1), 10, false);
}

TEST_CASE("fast direct: points among cylinders agree with the dense solution") {
  Placement placement = scattered(60, {8, 8}, disk("TE15", 0.2), 0.2);
  scatter(placement, 600, {8, 8}, Scatterer{}, 0.05);
  check_accuracy(placement, 30);
}

TEST_CASE("fast direct: clusters, dense boxes and strips agree with the dense solution") {
  Placement clusters;
  RandomStream random(13, 1, 0);
  for (int cluster = 0; cluster < 10; ++cluster) {
    const Vec place{40 * random.uniform(), 40 * random.uniform()};
    const double size = std::pow(10.0, -cluster / 3.0);
    for (int i = 0; i < 120; ++i)
      clusters.push_back({place + size * Vec{random.uniform(), random.uniform()}, Scatterer{}});
  }
  check_accuracy(clusters, 100);
  check_accuracy(scattered(1200, {1, 1}, Scatterer{}), 300);
  check_accuracy(scattered(1200, {0.5, 100}, Scatterer{}), 30, false);
}

TEST_CASE("fast direct: few scatterers, and distant ones that cannot be compressed") {
  for (const std::size_t count : {0, 1, 5, 300}) {
    const TMatrixSystem system(scattered(count, {1000, 1000}, Scatterer{}), two_pi, 1e-9);
    const std::vector<double> lights{1, 2};
    const auto rhs = system.right_hand_sides(lights);
    const FastDirect direct(system, 1e-9);
    auto x = rhs;
    direct.solve(x);
    CHECK(x.size() == 2 * count);
    if (count > 0) CHECK(relative_distance(system.apply(x), rhs) < 1e-9);
  }
}

TEST_CASE("fast direct: many right-hand sides agree with single ones") {
  const TMatrixSystem system(scattered(700, {8, 8}, Scatterer{}), two_pi, 1e-9);
  std::vector<double> lights;
  for (int i = 0; i < 70; ++i) lights.push_back(0.09 * i);
  const FastDirect direct(system, 1e-6);
  auto together = system.right_hand_sides(lights);
  direct.solve(together);
  for (const std::size_t light : {0, 63, 64, 69}) {
    auto alone = system.right_hand_sides({&lights[light], 1});
    direct.solve(alone);
    const std::span column(&together[light * 700], 700);
    CHECK(relative_distance(column, alone) < 1e-10);
  }
}

TEST_CASE("fast direct: results do not depend on the number of threads") {
  const TMatrixSystem system(scattered(1500, {12, 12}, Scatterer{}), two_pi, 1e-9);
  const std::vector<double> lights{0.4};
  std::vector<std::vector<Complex>> solutions;
  const int before = omp_get_max_threads();
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    const FastDirect direct(system, 1e-6);
    solutions.push_back(system.right_hand_sides(lights));
    direct.solve(solutions.back());
  }
  omp_set_num_threads(before);
  CHECK(solutions[0] == solutions[1]);
}

TEST_CASE("fast direct: the solution is invariant under a change of the unit of length") {
  Placement placement = scattered(900, {10, 10}, Scatterer{});
  const std::vector<double> lights{0.4};
  std::vector<std::vector<Complex>> solutions;
  for (const double unit : {1.0, 256.0}) {
    Placement scaled = placement;
    for (auto& placed : scaled) placed.position = unit * placed.position;
    const TMatrixSystem system(scaled, two_pi / unit, 1e-9);
    solutions.push_back(system.right_hand_sides(lights));
    FastDirect(system, 1e-6).solve(solutions.back());
  }
  CHECK(relative_distance(solutions[0], solutions[1]) < 1e-9);
}

TEST_CASE("fast direct: systems that exceed the memory are rejected in advance") {
  const TMatrixSystem system(scattered(2000, {14, 14}, Scatterer{}), two_pi, 1e-9);
  CHECK_NOTHROW(FastDirect(system, 1e-6, {.memory = 1e8}));
  try {
    FastDirect(system, 1e-6, {.memory = 1e6});
    FAIL("not refused");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("available bytes: 1000000;") != std::string::npos);
  }
}

TEST_CASE("fast direct: statistics of every level") {
  const TMatrixSystem system(scattered(2000, {14, 14}, Scatterer{}), two_pi, 1e-9);
  const FastDirect direct(system, 1e-6);
  const auto& statistics = direct.statistics();
  REQUIRE(statistics.levels.size() >= 3);
  CHECK(statistics.levels.back().boxes == 2);
  CHECK(statistics.root == statistics.levels.back().skeleton);
  for (const auto& level : statistics.levels) CHECK(level.skeleton < level.unknowns);
  CHECK(statistics.bytes > 16.0 * 500 * 500);
  CHECK(statistics.bytes < 16.0 * 2000 * 2000);
  CHECK(statistics.cpu_seconds > 0);
  CHECK(statistics.wall_seconds > 0);
}

}  // namespace flatspeckle::wave::test_fast_direct
