#include <cmath>
#include <functional>
#include <vector>

#include <doctest/doctest.h>

#include "core/parallel.h"
#include "grin/connection_solver.h"
#include "tests/grin/closed_fields.h"
#include "tests/grin/harmonic_curves.h"

namespace flatspeckle::grin {

using std::numbers::pi;
using tests::HarmonicBall;
using tests::HarmonicCurve;

namespace {

constexpr int functions = 3;
constexpr double wavenumber = 2;
using Values = std::array<double, functions>;

/// 1, 1/|J|, and the cosine of the phase.
Values values(double spreading, double optical_path) {
  return {1, 1 / spreading, std::cos(wavenumber * optical_path)};
}

struct Moments {
  Values sum{}, squares{};
  ConnectionStatistics statistics;

  void add(const ConnectionEstimate& estimate) {
    if (!estimate.curve) return;
    const Values f = values(estimate.curve->spreading, estimate.curve->optical_path);
    for (int i = 0; i < functions; ++i) {
      sum[i] += f[i] * estimate.multiplicity;
      squares[i] += std::pow(f[i] * estimate.multiplicity, 2);
    }
  }
  void add(const Moments& other) {
    for (int i = 0; i < functions; ++i) {
      sum[i] += other.sum[i];
      squares[i] += other.squares[i];
    }
    statistics += other.statistics;
  }
};

template <class Trial>
Moments estimated(const Trial& trial, int estimates, std::uint64_t seed) {
  std::vector<Moments> parts(100);
  parallel_for(parts.size(), [&](std::size_t part) {
    for (int i = 0; i < estimates / 100; ++i) {
      RandomStream random(seed, part, i);
      parts[part].add(connect(trial, random, parts[part].statistics));
    }
  });
  Moments all;
  for (const Moments& part : parts) all.add(part);
  return all;
}

void check_sums(const Moments& moments, int estimates, const std::vector<HarmonicCurve>& exact,
                double largest_error) {
  Values sums{};
  for (const HarmonicCurve& curve : exact) {
    const Values f = values(curve.spreading(), curve.optical_path());
    for (int i = 0; i < functions; ++i) sums[i] += f[i];
  }
  for (int i = 0; i < functions; ++i) {
    CAPTURE(i);
    const double mean = moments.sum[i] / estimates;
    const double error =
        std::sqrt((moments.squares[i] / estimates - mean * mean) / (estimates - 1));
    CHECK(error < largest_error * std::abs(sums[i]));
    CHECK(std::abs(mean - sums[i]) < 4 * error);
  }
}

constexpr WholeSpace everywhere;
const HarmonicBall field{{}};
const Vec3 from(0.3, 0.2, -0.4), to(-0.1, 0.5, 0.2);

}  // namespace

TEST_CASE("in Luneburg's ball f K has the mean f of the one curve") {
  const Inside<tests::Ball> ball{{1}};
  std::vector<HarmonicCurve> exact = tests::harmonic_curves(from, to, 2 * pi);
  std::erase_if(exact, [](const HarmonicCurve& curve) { return curve.largest_radius() > 1; });
  REQUIRE(exact.size() == 1);
  const ConnectionTrial trial(field, ball, from, to, {.step = 0.1, .max_length = 4});
  const int estimates = 400000;
  check_sums(estimated(trial, estimates, 81), estimates, exact, 0.002);
}

TEST_CASE("without the rim f K has the mean of the sum of f over all curves") {
  std::vector<HarmonicCurve> exact = tests::harmonic_curves(from, to, 6 * pi);
  const double longest = 6;
  std::erase_if(exact, [&](const HarmonicCurve& c) { return c.arc_length() > longest; });
  REQUIRE(exact.size() == 4);
  const ConnectionTrial trial(field, everywhere, from, to,
                              {.step = 0.15, .max_length = longest, .start = {.chord_share = 0.1}});
  const int estimates = 600000;
  const Moments moments = estimated(trial, estimates, 82);
  check_sums(moments, estimates, exact, 0.002);
  CHECK(moments.statistics.roulette_ends == 0);
}

TEST_CASE("roulette leaves the mean alone") {
  std::vector<HarmonicCurve> exact = tests::harmonic_curves(from, to, 6 * pi);
  const double longest = 6;
  std::erase_if(exact, [&](const HarmonicCurve& c) { return c.arc_length() > longest; });
  const ConnectionTrial trial(
      field, everywhere, from, to,
      {.step = 0.2, .max_length = longest, .start = {.chord_share = 0.1}, .roulette_after = 4});
  const int estimates = 100000;
  const Moments moments = estimated(trial, estimates, 83);
  check_sums(moments, estimates, exact, 0.02);
  CHECK(moments.statistics.roulette_ends > estimates / 20);
}

}  // namespace flatspeckle::grin
