#pragma once

#include <algorithm>
#include <vector>

#include <doctest/doctest.h>

#include "bench/oracles/harmonic_ball.h"
#include "grin/rays/connections/connection_solver.h"

namespace flatspeckle::grin::tests {

using oracles::HarmonicCurve;

inline constexpr WholeSpace everywhere;

struct Listed {
  std::vector<FoundConnection> curves;
  ConnectionStatistics statistics;
};

template <class Step = Sharma, IndexField F, Region R>
Listed listed(const F& field, const R& region, const Vec3& p, const Vec3& q,
              const ConnectionOptions& options, int trials, std::uint64_t seed) {
  const ConnectionTrial<F, R, Step> trial(field, region, p, q, options);
  RandomStream random(seed, 0, 0);
  Listed list;
  list.curves = all_connections(trial, trials, random, list.statistics);
  return list;
}

inline void check_curve(const Connection& found, const HarmonicCurve& exact) {
  CHECK(found.sigma == doctest::Approx(exact.sigma).epsilon(1e-6));
  CHECK(found.arc_length == doctest::Approx(exact.arc_length()).epsilon(1e-6));
  CHECK(found.optical_path == doctest::Approx(exact.optical_path()).epsilon(1e-6));
  CHECK((found.start_direction - exact.v0.normalized()).norm() < 1e-5);
  CHECK((found.end_direction - exact.v(exact.sigma).normalized()).norm() < 1e-5);
  CHECK(found.spreading == doctest::Approx(exact.spreading()).epsilon(1e-4));
  CHECK(found.caustics == exact.caustics());
  CHECK(found.orientation == (exact.caustics() % 2 ? -1 : 1));
}

/// Checks that the list contains all exact curves and no others.
inline void check_all_found(const Listed& list, std::vector<HarmonicCurve> exact) {
  std::sort(exact.begin(), exact.end(), [](const HarmonicCurve& a, const HarmonicCurve& b) {
    return a.optical_path() < b.optical_path();
  });
  REQUIRE(list.curves.size() == exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) check_curve(list.curves[i].curve, exact[i]);
}

}  // namespace flatspeckle::grin::tests
