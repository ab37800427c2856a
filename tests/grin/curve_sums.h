#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "bench/oracles/harmonic_ball.h"
#include "core/run/parallel.h"
#include "grin/rays/connections/connection_solver.h"
#include "tests/statistics.h"

// Sums of functions over the curves between two points of a harmonic ball. Estimates weighted by
// the multiplicity K (conventions, C26) are compared with exact sums.
namespace flatspeckle::grin::tests {

using namespace oracles;

constexpr int functions = 3;
constexpr double wavenumber = 2;
using Values = std::array<double, functions>;

/// Returns the functions that are summed: 1, 1/|J|, and the cosine of the phase.
inline Values values(double spreading, double optical_path) {
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
      RandomStream random(flatspeckle::tests::fresh_seed(seed), part, i);
      parts[part].add(connect(trial, random, parts[part].statistics));
    }
  });
  Moments all;
  for (const Moments& part : parts) all.add(part);
  return all;
}

inline void check_sums(const Moments& moments, int estimates,
                       const std::vector<HarmonicCurve>& exact, double largest_error) {
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

inline const HarmonicBall field{{}};
inline const Vec3 from(0.3, 0.2, -0.4), to(-0.1, 0.5, 0.2);

/// Checks the sums over the four curves of arc length up to 6, from `estimates` estimates. The
/// relative standard error must be at most `largest_error`.
inline void check_four_curves(int estimates, double largest_error) {
  std::vector<HarmonicCurve> exact = harmonic_curves(from, to, 6 * std::numbers::pi);
  const double longest = 6;
  std::erase_if(exact, [&](const HarmonicCurve& c) { return c.arc_length() > longest; });
  REQUIRE(exact.size() == 4);
  const ConnectionTrial trial(field, WholeSpace(), from, to,
                              {.step = 0.15, .max_length = longest, .start = {.chord_share = 0.1}});
  const Moments moments = estimated(trial, estimates, 82);
  check_sums(moments, estimates, exact, largest_error);
  CHECK(moments.statistics.roulette_terminations == 0);
}

}  // namespace flatspeckle::grin::tests
