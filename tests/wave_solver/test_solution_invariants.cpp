// Checks the diagnosis of a solution: power balance and sensitivity to rounding of the radius.

#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "reference.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/solutions/solution_invariants.h"

namespace flatspeckle::wave::test_solution_invariants {

namespace {

constexpr double tolerance = 1e-9;
const std::vector<double> lights{0.3, 2.0};

Placement points(double albedo) {
  return read_placement(reference_path("p50/placement.csv"), {.albedo = albedo});
}

std::vector<Placement> clusters() {
  std::vector<Placement> all{points(1), points(0.8)};
  for (const char* kind : {"D", "N", "TM15", "TE15", "TM15abs", "TE15abs"})
    all.push_back(reference_placement("g10", kind));
  return all;
}

// Returns a solution with elements of the T-matrix and of the translations multiplied by factors.
WaveSolution altered(const Placement& placement, double t_factor, double translation_factor) {
  TMatrixSystem system(placement, two_pi, tolerance);
  Entries matrix = system.matrix();
  const std::size_t n = system.unknowns();
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i)
      matrix[i + n * j] =
          i == j ? matrix[i + n * j] / t_factor : matrix[i + n * j] * translation_factor;
  auto x = DenseFactor(std::move(matrix), n).solve(system.right_hand_sides(lights));
  return WaveSolution(std::move(system), lights, std::move(x));
}

// Returns a disk whose wave of order n resonates, searched from k radius = from upwards.
Scatterer resonant(int n, double index, double from) {
  Scatterer disk{.kind = Scatterer::Kind::tm, .index = index};
  const auto detuning = [&](double x) {
    disk.radius = x / two_pi;
    return static_cast<double>((1.0L / t_matrix(disk, two_pi, n)[n]).imag());
  };
  constexpr double step = 0.003;
  for (double x = from;; x += step) {
    double low = x, high = x + step;
    const double first = detuning(low);
    if (first * detuning(high) > 0) continue;
    for (int i = 0; i < 100; ++i) {
      const double middle = (low + high) / 2;
      (detuning(middle) * first > 0 ? low : high) = middle;
    }
    if (std::abs(detuning(low)) < 0.01 * std::abs(first)) return disk;
  }
}

}  // namespace

TEST_CASE(
    "power balance: extinction equals scattering plus absorption for all kinds of scatterers") {
  for (const Placement& placement : clusters()) {
    const auto solution = solve(placement, two_pi, lights, {.tolerance = tolerance, .sensors = {}});
    const auto [off, limit] = power_balance(solution, tolerance);
    CHECK(off <= limit);
    CHECK(limit < 1e-6);
    CHECK(solution.diagnosis().power.off == off);
    CHECK(solution.diagnosis().keeps_invariants());
  }
}

TEST_CASE("power balance: a factor 1.01 in T-matrices, translations or amplitudes is detected") {
  for (const Placement& placement : clusters()) {
    for (const auto& [t_factor, translation_factor] :
         {std::pair{1.0, 1.0}, {1.01, 1.0}, {1.0, 1.01}}) {
      const auto [off, limit] =
          power_balance(altered(placement, t_factor, translation_factor), tolerance);
      CHECK((off > 10 * limit) == (t_factor * translation_factor != 1));
    }
    const auto solution = solve(placement, two_pi, lights, {.tolerance = tolerance, .sensors = {}});
    std::vector<Complex> louder;
    for (std::size_t light = 0; light < lights.size(); ++light)
      for (const Complex beta : solution.coefficients(light)) louder.push_back(1.01 * beta);
    const auto [off, limit] =
        power_balance(WaveSolution(solution.system(), lights, louder), tolerance);
    CHECK(off > 1e-3);
    CHECK(off > limit);
  }
}

TEST_CASE("power balance: holds from k radius = 1e-4 to 300") {
  for (const double size : {1e-4, 0.01, 1.0, 300.0})
    for (const auto kind : {Scatterer::Kind::tm, Scatterer::Kind::te}) {
      const Scatterer disk{.kind = kind, .radius = size / two_pi, .index = {1.5, 0.01}};
      const Placement two{{{3, 5}, disk}, {{3, 5 + 2.5 * disk.radius}, disk}};
      const auto solution = solve(two, two_pi, {0.3}, {});
      CAPTURE(size);
      CHECK(solution.diagnosis().power.holds());
    }
}

TEST_CASE(
    "rounding: the estimate agrees with the change for a radius one unit in the last place away") {
  for (const int n : {10, 15, 24}) {
    Placement one{{{0, 0}, resonant(n, 2, n / 2.0)}};
    const auto solution = solve(one, two_pi, {0.3}, {});
    one[0].scatterer.radius =
        std::nextafter(one[0].scatterer.radius, std::numeric_limits<double>::max());
    const Complex moved = solve(one, two_pi, {0.3}, {}).far_field(1), here = solution.far_field(1);
    const double change = std::abs(moved - here) / std::abs(here),
                 rounding = solution.diagnosis().rounding.off;
    CAPTURE(n);
    CHECK(rounding > change / 2);
    CHECK(rounding < 20 * change);
    CHECK(solution.diagnosis().keeps_invariants() == (rounding <= 1e-12));
    CHECK((rounding > 1e-12) == (n > 10));  // Q from 1e3 to 4e7
  }
}

}  // namespace flatspeckle::wave::test_solution_invariants
