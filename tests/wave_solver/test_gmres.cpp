#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "reference.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/solutions/wave_solution.h"
#include "wave_solver/sums/block_krylov.h"
#include "wave_solver/sums/fast_product.h"

namespace flatspeckle::wave::test_gmres {

namespace {

TMatrixSystem points(std::size_t count, double side, double phase_shift) {
  RandomStream random(4, 1, count);
  Placement placement;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = side * random.uniform(), z = side * random.uniform();
    placement.push_back({{x, z}, {.kind = Scatterer::Kind::point, .phase_shift = phase_shift}});
  }
  return {placement, two_pi, 1e-12};
}

std::vector<double> lights(int count) {
  std::vector<double> angles;
  for (int i = 0; i < count; ++i) angles.push_back(0.1 * i - 0.5);
  return angles;
}

// Returns ||b - A x|| / ||b|| of every column, with the block-by-block product.
std::vector<double> residuals(const TMatrixSystem& system, std::span<const Complex> x,
                              std::span<const Complex> b) {
  const auto product = system.apply(x);
  const std::size_t n = system.unknowns();
  std::vector<double> residuals;
  for (std::size_t at = 0; at < b.size(); at += n)
    residuals.push_back(relative_distance(std::span(product).subspan(at, n), b.subspan(at, n)));
  return residuals;
}

BlockMap dense_map(const Entries& matrix, std::size_t n) {
  return [&matrix, n](std::span<const Complex> x) {
    std::vector<Complex> y(x.size());
    for (std::size_t c = 0; c < x.size() / n; ++c)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i < n; ++i) y[c * n + i] += matrix[j * n + i] * x[c * n + j];
    return y;
  };
}

}  // namespace

TEST_CASE("gmres: weak points agree with the dense solution") {
  const auto system = points(800, 25, 0.3);
  const FastProduct product(system, 1e-12);
  const auto angles = lights(3);
  const auto b = system.right_hand_sides(angles);
  const auto found =
      gmres([&](auto x) { return product(x); }, system.unknowns(), b, {.tolerance = 1e-10});
  CHECK(found.converged);
  const auto solution =
      solve(system.placement(), two_pi, angles, {.tolerance = 1e-12, .sensors = {}});
  for (std::size_t light = 0; light < angles.size(); ++light) {
    CHECK(found.residuals[light] <= 1e-10);
    const std::span x = std::span(found.x).subspan(light * system.unknowns(), system.unknowns());
    CHECK(relative_distance(x, solution.coefficients(light)) < 1e-9);
  }
  const auto checked = residuals(system, found.x, b);
  for (std::size_t light = 0; light < angles.size(); ++light)
    CHECK(std::abs(checked[light] - found.residuals[light]) < 1e-11);
}

TEST_CASE("gmres: resonant points are reported as not converged") {
  const auto system = points(600, 6, two_pi / 4);
  const auto matrix = system.matrix();
  const auto b = system.right_hand_sides(lights(2));
  const auto found = gmres(dense_map(matrix, 600), 600, b, {.tolerance = 1e-8, .products = 40});
  CHECK(!found.converged);
  const auto checked = residuals(system, found.x, b);
  for (std::size_t light = 0; light < 2; ++light) {
    CHECK(found.residuals[light] > 1e-8);
    CHECK(found.residuals[light] < 1);
    CHECK(found.residuals[light] == doctest::Approx(checked[light]).epsilon(1e-6));
    CHECK(found.steps[light] <= 40);
  }
}

TEST_CASE("gmres: stagnating restarts stop and report the residual") {
  const auto system = points(600, 6, two_pi / 4);
  const auto matrix = system.matrix();
  const auto found = gmres(dense_map(matrix, 600), 600, system.right_hand_sides(lights(1)),
                           {.tolerance = 1e-10, .products = 100000, .basis_bytes = 16 * 600 * 20});
  CHECK(!found.converged);
  CHECK(found.residuals[0] > 1e-10);
  CHECK(found.steps[0] < 10000);
}

TEST_CASE("gmres: restarts that make progress reach the tolerance") {
  const auto system = points(500, 30, 0.3);
  const auto matrix = system.matrix();
  const auto found = gmres(dense_map(matrix, 500), 500, system.right_hand_sides(lights(2)),
                           {.tolerance = 1e-10, .basis_bytes = 16 * 500 * 60});
  CHECK(found.converged);
  CHECK(found.steps[0] > 30);
}

TEST_CASE("gmres: right-hand sides that share a space need fewer steps than single ones") {
  const std::size_t n = 500;
  const auto system = points(n, 12, 0.3);
  const auto matrix = system.matrix();
  const auto b = system.right_hand_sides(lights(8));
  const auto apart = gmres(dense_map(matrix, n), n, b, {.tolerance = 1e-6, .block = 1});
  const auto together = gmres(dense_map(matrix, n), n, b, {.tolerance = 1e-6, .block = 8});
  CHECK(apart.converged);
  CHECK(together.converged);
  CHECK(together.steps[0] * 2 < apart.steps[0]);
  CHECK(relative_distance(together.x, apart.x) < 1e-4);
}

TEST_CASE("gmres: dependent, equal and vanishing right-hand sides") {
  const auto system = points(200, 8, 0.3);
  const auto matrix = system.matrix();
  const std::size_t n = 200;
  auto b = system.right_hand_sides(lights(4));
  for (std::size_t i = 0; i < n; ++i) {
    b[n + i] = b[i];
    b[2 * n + i] = 0;
    b[3 * n + i] *= 1e-20;
  }
  const auto found = gmres(dense_map(matrix, n), n, b, {.tolerance = 1e-11});
  CHECK(found.converged);
  CHECK(found.residuals[2] == 0);
  const auto checked = residuals(system, found.x, b);
  for (const std::size_t column : {0, 1, 3}) CHECK(checked[column] < 1.1e-11);
  for (std::size_t i = 0; i < n; ++i) CHECK(found.x[2 * n + i] == Complex());
}

TEST_CASE("gmres: more right-hand sides than unknowns, and exhausted spaces") {
  for (const std::size_t n : {1, 2, 7}) {
    const auto system = points(n, 2, two_pi / 4);
    const auto matrix = system.matrix();
    const auto b = system.right_hand_sides(lights(11));
    const auto found = gmres(dense_map(matrix, n), n, b, {.tolerance = 1e-12});
    CHECK(found.converged);
    const auto checked = residuals(system, found.x, b);
    CHECK(*std::max_element(checked.begin(), checked.end()) < 2e-12);
  }
  CHECK(gmres({}, 0, {}).converged);
}

// The preconditioner is a solution to three digits, like that of an inaccurate factorization.
TEST_CASE(
    "gmres: with an approximate inverse as preconditioner resonant points converge in few steps") {
  const auto system = points(400, 6, two_pi / 4);
  const auto matrix = system.matrix();
  const auto b = system.right_hand_sides(lights(3));
  const BlockMap inverse = [&](std::span<const Complex> x) {
    std::vector<Complex> y(x.begin(), x.end());
    return gmres(dense_map(matrix, 400), 400, x, {.tolerance = 1e-3}).x;
  };
  const auto found =
      gmres(dense_map(matrix, 400), 400, b, {.tolerance = 1e-11, .preconditioner = inverse});
  CHECK(found.converged);
  CHECK(found.steps[0] <= 8);
}

}  // namespace flatspeckle::wave::test_gmres
