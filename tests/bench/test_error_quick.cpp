// Measures every curve of `flatspeckle bench error` briefly and checks that it has the right shape.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "bench/cost/cost_curve.h"
#include "bench/error/error_curve.h"
#include "core/run/parallel.h"

namespace flatspeckle::bench::test_error_quick {

namespace {

constexpr double cpu_seconds = 2;

bool is_rising(const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!(values[i] > (i > 0 ? values[i - 1] : 0)) || !std::isfinite(values[i])) return false;
  return true;
}

template <class Run, class Curve>
std::vector<Curve> run_all(const std::vector<Run>& runs) {
  std::vector<Curve> curves(runs.size());
  flatspeckle::parallel_for(runs.size(),
                            [&](std::size_t i) { curves[i] = runs[i].run(cpu_seconds); });
  return curves;
}

}  // namespace

TEST_CASE("nightly: bench_error_quick: error curves") {
  for (const ErrorCurve& curve : run_all<ErrorRun, ErrorCurve>(error_runs())) {
    CAPTURE(curve.scene);
    CAPTURE(curve.method);
    std::vector<double> times, samples;
    for (const ErrorPoint& point : curve.points) {
      CHECK(std::isfinite(point.error));
      CHECK(point.error > 0);
      times.push_back(point.cpu_s);
      samples.push_back(point.samples);
    }
    CHECK(times.size() >= 3);
    CHECK_FALSE(curve.reference.empty());
    if (!curve.has_slope()) continue;
    CHECK(is_rising(samples));
    if (curve.is_monte_carlo)
      CHECK(is_rising(times));
    else  // with more samples, fewer iterations may suffice
      CHECK(times.back() > times.front());
    CHECK(std::isfinite(curve.slope_error));
    CHECK(std::isfinite(curve.efficiency));
    CHECK(curve.efficiency > 0);
    if (curve.is_monte_carlo) {
      CHECK(std::abs(curve.slope + 0.5) < 4 * curve.slope_error);
      CHECK(curve.slope_error < 0.5 / 4);  // small enough to detect a curve that does not fall
    }
  }
}

TEST_CASE("nightly: bench_error_quick: cost curves") {
  for (const CostCurve& curve : run_all<CostRun, CostCurve>(cost_runs())) {
    CAPTURE(curve.what);
    CHECK(curve.size.size() == curve.cpu_s.size());
    CHECK(curve.size.size() >= 4);
    CHECK(is_rising(curve.size));
    if (curve.expected > 0) CHECK(curve.cpu_s.back() > curve.cpu_s.front());
    CHECK(std::isfinite(curve.exponent));
    CHECK(std::isfinite(curve.exponent_error));
  }
}

}  // namespace flatspeckle::bench::test_error_quick
