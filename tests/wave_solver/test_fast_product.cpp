#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include <doctest/doctest.h>
#include <omp.h>

#include "core/numbers/random.h"
#include "reference.h"
#include "tests/statistics.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/spheres/sphere_pairs.h"
#include "wave_solver/sums/fast_product.h"
#include "wave_solver/sums/space_product.h"

namespace flatspeckle::wave::test_fast_product {

namespace {

using flatspeckle::tests::is_night;
using Kind = Scatterer::Kind;

// Returns scatterers on a square grid, shifted at random within their squares.
Placement shaken_grid(std::size_t side, double square, const std::vector<Scatterer>& scatterers) {
  RandomStream random(3, 1, side);
  Placement placement;
  for (std::size_t i = 0; i < side * side; ++i) {
    const Scatterer& s = scatterers[i % scatterers.size()];
    const double spare = std::max(0.0, square - 2.05 * s.disk_radius());
    placement.push_back({{square * static_cast<double>(i % side) + spare * random.uniform(),
                          square * static_cast<double>(i / side) + spare * random.uniform()},
                         s});
  }
  return placement;
}

std::vector<Complex> random_columns(std::size_t size) {
  RandomStream random(8, 1, 0);
  std::vector<Complex> values(size);
  for (Complex& value : values) value = {random.uniform() - 0.5, random.uniform() - 0.5};
  return values;
}

Scatterer disk(Kind kind, double radius, Complex index = 1.5) {
  return {.kind = kind, .radius = radius, .index = index};
}

struct Disks {
  std::size_t side;
  double square;
  std::vector<Scatterer> scatterers;
};

const std::vector<Disks> all_disks{
    {9, 0.6, {disk(Kind::soft, 0.2)}},
    {6, 3, {disk(Kind::te, 1.1)}},
    {7, 2.5, {disk(Kind::tm, 0.9, {1.5, 0.1}), disk(Kind::soft, 0.1), {.kind = Kind::point}}},
    {9, 0.01, {disk(Kind::hard, 0.004)}},
    {8, 1.5, {disk(Kind::tm, 0.5, 3.2), disk(Kind::tm, 0.61, 3.2)}},
    {8, 0.6, {disk(Kind::hard, 0.25)}},  // from here on in nightly runs only
    {4, 9, {disk(Kind::soft, 4)}},
};

}  // namespace

TEST_CASE("multipole ring: an infinite range needs no points and no charges") {
  const TMatrixSystem system({{{0, 0}, disk(Kind::tm, 0.3)}}, 2 * std::numbers::pi, 1e-10);
  MultipoleRing ring(system.modes(0), system.k(), 0.3, std::numeric_limits<double>::infinity(),
                     1e-10);
  CHECK(ring.points == 0);
  ring.charge(system.modes(0), system.k());
  CHECK(ring.charges.empty());
}

TEST_CASE("ring product: grid and near blocks agree with the block-by-block product at any range") {
  for (const Disks& disks : std::span(all_disks).first(is_night ? 7 : 5)) {
    const TMatrixSystem system(shaken_grid(disks.side, disks.square, disks.scatterers), two_pi,
                               1e-10);
    const auto x = random_columns(2 * system.unknowns());
    const auto exact = system.apply(x);
    const double extent = disks.square * static_cast<double>(disks.side);
    for (const double range : {extent / 12, extent / 4})
      for (const double tolerance : {1e-5, 1e-11}) {
        if (!is_night && (range < extent / 8) == (tolerance < 1e-8)) continue;
        CAPTURE(disks.square);
        CAPTURE(range);
        CAPTURE(tolerance);
        const RingProduct product(system, range, tolerance);
        CHECK(product.resolved());
        CHECK(relative_distance(product(x), exact) < tolerance);
      }
    const RingProduct stored(system, std::numeric_limits<double>::infinity(), 1e-12);
    CHECK(relative_distance(stored(x), exact) < 1e-14);
    CHECK(relative_distance(FastProduct(system, 1e-12)(x), exact) < 1e-12);
  }
}

TEST_CASE("fast product of points: agrees with the block-by-block product within the tolerance") {
  Placement placement = shaken_grid(40, 0.3, {{.kind = Kind::point, .phase_shift = 0.3}});
  for (std::size_t i = 0; i < placement.size(); i += 3) placement[i].scatterer.phase_shift = 1.2;
  const TMatrixSystem system(placement, two_pi, 1e-12);
  const auto x = random_columns(3 * system.unknowns());
  const auto exact = system.apply(x);
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12})
    CHECK(relative_distance(FastProduct(system, tolerance)(x), exact) < tolerance);
}

TEST_CASE("product of points in space: agrees with direct sums within the tolerance") {
  Placement placement;
  RandomStream random(4, 1, 0);
  for (std::size_t i = 0; i < 8000; ++i)
    placement.push_back({{4 * random.uniform(), 3 * random.uniform(), 5 * random.uniform()},
                         {.kind = Kind::point, .phase_shift = i % 3 == 0 ? 1.2 : 0.1}});
  BasisOrders orders(two_pi, 1e-12, sphere_rules());
  const SphereEquations equations(placement, two_pi, orders.basis(placement, {}));
  const auto x = random_columns(equations.unknowns());
  const auto exact = equations.apply(x);
  for (const double tolerance : {1e-3, 1e-6}) {
    const SpaceProduct product(equations, tolerance);
    CHECK(product.range() > 0);
    CHECK(relative_distance(product(x), exact) < tolerance);
  }
}

TEST_CASE("fast product: no scatterer, one, and two close ones") {
  CHECK(FastProduct(TMatrixSystem({}, two_pi, 1e-10), 1e-10)({}).empty());
  for (const Placement& placement :
       {Placement{{{1, 2}, disk(Kind::soft, 0.3)}}, Placement{{{1, 2}, {.kind = Kind::point}}},
        Placement{{{0, 0}, disk(Kind::hard, 0.3)}, {{0.601, 0}, disk(Kind::hard, 0.3)}}}) {
    const TMatrixSystem system(placement, two_pi, 1e-10);
    const auto x = random_columns(system.unknowns());
    CHECK(relative_distance(FastProduct(system, 1e-12)(x), system.apply(x)) < 1e-12);
  }
}

// Whispering-gallery resonances: T_n is close to 1 although J_n(k a) is below 1e-6.
TEST_CASE("fast product: waves too singular for a grid are detected and multiplied without one") {
  const TMatrixSystem system(shaken_grid(is_night ? 10 : 7, 2.4, {disk(Kind::tm, 1, 6.0)}), two_pi,
                             1e-10);
  CHECK(!RingProduct(system, 3, 1e-12).resolved());
  const auto x = random_columns(system.unknowns());
  CHECK(relative_distance(FastProduct(system, 1e-12)(x), system.apply(x)) < 1e-12);
}

TEST_CASE("ring product: results do not depend on the number of threads") {
  const TMatrixSystem system(shaken_grid(14, 0.6, {disk(Kind::soft, 0.2)}), two_pi, 1e-8);
  const auto x = random_columns(2 * system.unknowns());
  const int threads = omp_get_max_threads();
  std::vector<std::vector<Complex>> products;
  for (const int count : {1, 2, 5}) {
    omp_set_num_threads(count);
    products.push_back(RingProduct(system, 1.5, 1e-8)(x));
  }
  omp_set_num_threads(threads);
  for (const auto& other : products) CHECK(other == products[0]);
}

}  // namespace flatspeckle::wave::test_fast_product
