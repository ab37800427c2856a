// Checks random placements: solutions agree with those of twice the order within the tolerance, or
// are rejected, or are reported as not converged.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "reference.h"
#include "tests/statistics.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_random_placements {

namespace {

const std::vector<double> lights{0.3, 2.1};

std::vector<double> angles_around() {
  std::vector<double> angles;
  for (int i = 0; i < 24; ++i) angles.push_back(two_pi * i / 24);
  return angles;
}

// Returns far fields of a dense solution whose orders are `growth` times those chosen.
std::vector<Complex> fields_of_order(const Placement& placement, double tolerance, double growth) {
  const TMatrixSystem system(placement, two_pi, tolerance, {}, growth);
  DenseFactor factor(system.matrix(), system.unknowns());
  const auto x = factor.solve(system.right_hand_sides(lights));
  return transposed_product(system.far_rows(angles_around()), x.data(), lights.size(),
                            system.unknowns());
}

enum class Outcome { held, missed, refused, not_converged, large };

// Compares a solution with one of higher order; placements with too many unknowns are skipped.
Outcome outcome(const Placement& placement, double tolerance, std::size_t most_unknowns) try {
  check_no_overlap(placement);
  if (TMatrixSystem(placement, two_pi, tolerance).unknowns() > most_unknowns) return Outcome::large;
  const auto solution = solve(placement, two_pi, lights, {.tolerance = tolerance, .sensors = {}});
  if (!solution.diagnosis().keeps_invariants()) return Outcome::not_converged;
  const bool grown = solution.diagnosis().truncation.limit > 0;
  std::vector<View> views;
  for (const double angle : angles_around()) views.push_back(far_view(angle));
  const auto expected = fields_of_order(placement, tolerance, grown ? 2.5 : 2);
  // The distance is 0 / 0 if nothing scatters.
  return relative_distance(solution.fields(views), expected) > tolerance ? Outcome::missed
                                                                         : Outcome::held;
} catch (const InputError&) {
  return Outcome::refused;
}

// Draws placements of random kinds, sizes, indices and gaps.
class Draw {
 public:
  explicit Draw(std::uint64_t number) : random_(60, 0, number) {}

  double uniform(double low, double high) { return low + (high - low) * random_.uniform(); }
  double logarithmic(double low, double high) {
    return low * std::pow(high / low, random_.uniform());
  }
  std::size_t one_of(std::size_t count) {
    return static_cast<std::size_t>(random_.uniform() * static_cast<double>(count));
  }

  Complex index() {
    switch (one_of(6)) {
      case 0:
        return {uniform(1.05, 2), 0};
      case 1:
        return {uniform(2, 6), one_of(2) == 0 ? 0 : logarithmic(1e-6, 1)};
      case 2:  // a metal
        return std::sqrt(Complex(-logarithmic(1.05, 30), logarithmic(1e-4, 3)));
      case 3:  // plasmons of single disks
        return std::sqrt(Complex(-1 + (one_of(2) == 0 ? 1 : -1) * logarithmic(1e-3, 0.9),
                                 logarithmic(1e-4, 0.3)));
      case 4:
        return std::sqrt(std::polar(logarithmic(0.05, 50), uniform(0, std::numbers::pi)));
      default:
        return {uniform(0.3, 0.99), one_of(2) == 0 ? 0 : logarithmic(1e-4, 1)};
    }
  }

  // Draws a placement in which each disk has a gap of random size to an earlier one.
  Placement placement(double least_gap) {
    const auto kind = static_cast<Scatterer::Kind>(1 + std::min<std::size_t>(3, one_of(6)));
    const std::size_t count = 2 + one_of(4);
    const double largest = logarithmic(0.03, 8) / two_pi;
    const bool equal = one_of(2) == 0;
    const Complex shared = index();
    const auto disk = [&] {
      Scatterer made{.kind = kind, .radius = equal ? largest : largest * logarithmic(0.15, 1)};
      made.index = equal || one_of(2) == 0 ? shared : index();
      return made;
    };
    Placement placement{{{0, 0}, disk()}};
    for (int tries = 0; placement.size() < count && tries < 200; ++tries) {
      const Scatterer next = disk();
      const auto& [centre, other] = placement[one_of(placement.size())];
      const double gap = logarithmic(least_gap, 1) * std::min(next.radius, other.radius);
      const Vec place = centre + (next.radius + other.radius + gap) * direction(uniform(0, two_pi));
      const bool free =
          std::ranges::all_of(placement, [&, &centre = centre](const PlacedScatterer& placed) {
            const double reach = placed.scatterer.radius + next.radius;
            return length(placed.position - place) > (1 + 1e-7) * reach ||
                   length(placed.position - centre) == 0;
          });
      if (free) placement.push_back({place, next});
    }
    return placement;
  }

 private:
  RandomStream random_;
};

struct Counts {
  int held = 0, refused = 0, not_converged = 0, large = 0;

  void add(Outcome found) {
    held += found == Outcome::held;
    refused += found == Outcome::refused;
    not_converged += found == Outcome::not_converged;
    large += found == Outcome::large;
  }
};

Counts check_placements(std::uint64_t first, std::uint64_t count, double least_gap,
                        std::size_t most_unknowns) {
  Counts counts;
  for (std::uint64_t number = first; number < first + count; ++number) {
    Draw draw(number);
    const double tolerance = draw.logarithmic(1e-10, 1e-3);
    const Outcome found = outcome(draw.placement(least_gap), tolerance, most_unknowns);
    CAPTURE(number);
    CAPTURE(tolerance);
    CHECK(found != Outcome::missed);
    counts.add(found);
  }
  MESSAGE(counts.held << " held, " << counts.refused << " refused, " << counts.not_converged
                      << " not converged, " << counts.large << " too large to compare");
  return counts;
}

Placement pair_of(Scatterer::Kind kind, Complex index, Vec radii, double gap) {
  const Scatterer first{.kind = kind, .radius = radii.x, .index = index},
      second{.kind = kind, .radius = radii.z, .index = index};
  return {{{0, 0}, first}, {{0, radii.x + radii.z + gap * std::min(radii.x, radii.z)}, second}};
}

}  // namespace

TEST_CASE("random placements: agree with twice the order within the tolerance, or are rejected") {
  const Counts counts = check_placements(0, 40, 1e-2, 250);
  CHECK(counts.held > 20);
}

TEST_CASE("nightly: 500 random placements with gaps from 1e-6 radii agree with twice the order") {
  const Counts counts = check_placements(1000, 500, 1e-6, 600);
  CHECK(counts.held > 250);
}

TEST_CASE("metal pairs with narrow gaps: agree with twice the order within the tolerance") {
  const auto te = Scatterer::Kind::te;
  CHECK(outcome(pair_of(te, {0.05, 1.5}, {0.3, 0.45}, 0.1), 1e-8, 1500) == Outcome::held);
  CHECK(outcome(pair_of(te, {0.05, 2.2}, {0.1, 0.1}, 0.02), 1e-6, 1500) == Outcome::held);
  CHECK(outcome(pair_of(te, {0.001, 1.001}, {0.02, 0.02}, 0.3), 1e-9, 1500) == Outcome::held);
  CHECK(outcome(pair_of(te, {0.00013, 0.9965}, {0.0063, 0.0063}, 0.0075), 3.4e-5, 1500) !=
        Outcome::missed);
}

TEST_CASE(
    "three metal disks that resonate collectively: agree with higher orders or are not converged") {
  const auto disk = [](double radius, Complex index) {
    return Scatterer{.kind = Scatterer::Kind::te, .radius = radius, .index = index};
  };
  const Complex index(0.00046, 0.9989);
  const Placement three{{{0, 0}, disk(0.02, index)},
                        {{0, 0.0406}, disk(0.02, index)},
                        {{0.0247, 0.0203}, disk(0.01, index)}};
  const Outcome found = outcome(three, 1e-4, 1500);
  CHECK((found == Outcome::held || found == Outcome::not_converged));
}

TEST_CASE(
    "nightly: metal pairs of high orders: agree with twice the order, rejected or not converged") {
  const auto te = Scatterer::Kind::te;
  for (const double tolerance : {1e-4, 1e-6, 1e-8})
    CHECK(outcome(pair_of(te, {0.05, 2.2}, {0.1, 0.1}, 0.002), tolerance, 4000) != Outcome::missed);
  CHECK(outcome(pair_of(te, {0.05, 1.5}, {0.3, 0.45}, 0.01), 1e-12, 4000) != Outcome::missed);
}

TEST_CASE(
    "index^2 over the complex plane, gaps to rounding: within the tolerance, rejected or "
    "reported") {
  Counts counts;
  int number = 0;
  for (const double size : {0.3, 1.0, 4.0, 40.0})
    for (const double turn : {0.0, 0.25, 0.5, 0.8, 0.97, 0.9999, 1.0})
      for (const double gap : {1e-16, 1e-14, 1e-12, 1e-9, 1e-6, 1e-3, 0.03, 0.3, 1.0})
        for (const auto kind : {Scatterer::Kind::tm, Scatterer::Kind::te}) {
          const bool plasmons = kind == Scatterer::Kind::te && turn > 0.5 && gap < 0.03;
          if (!flatspeckle::tests::is_night && (++number % 5 != 0 || plasmons)) continue;
          const Complex index = std::sqrt(std::polar(size, std::numbers::pi * turn));
          CAPTURE(index);
          CAPTURE(gap);
          const Outcome found = outcome(pair_of(kind, index, {0.1, 0.07}, gap), 1e-8,
                                        flatspeckle::tests::is_night ? 1500 : 400);
          CHECK(found != Outcome::missed);
          counts.add(found);
        }
  CHECK(counts.held > 30);
}

}  // namespace flatspeckle::wave::test_random_placements
