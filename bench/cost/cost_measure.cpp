#include "bench/cost/cost_measure.h"

#include <cmath>
#include <span>

#include <omp.h>

#include "bench/measure/median.h"
#include "bench/measure/power_fit.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

/// Returns the CPU seconds of one call, averaged over enough calls for the resolution of the clock.
double seconds_of(const std::function<void()>& work) {
  constexpr double least = 2e-3;
  const double start = thread_cpu_seconds();
  int calls = 0;
  double spent = 0;
  while (spent < least) {
    work();
    ++calls;
    spent = thread_cpu_seconds() - start;
  }
  return spent / calls;
}

}  // namespace

std::vector<CostRun> cost_runs() {
  std::vector<CostRun> runs;
  for (const auto& some : {wave_cost_runs(), transport_cost_runs(), ray_cost_runs()})
    runs.insert(runs.end(), some.begin(), some.end());
  return runs;
}

CostRun cost_run(const Scaling& scaling) {
  return {scaling.what,
          [scaling](double cpu_seconds) { return measure_cost(scaling, cpu_seconds); }};
}

void fit_exponent(CostCurve& curve) {
  const std::size_t used = std::min<std::size_t>(4, curve.size.size());
  const auto fitted =
      fit_power(std::span(curve.size).last(used), std::span(curve.cpu_s).last(used));
  curve.exponent = fitted.exponent;
  curve.exponent_error = fitted.exponent_error;
}

CostCurve measure_cost(const Scaling& scaling, double cpu_seconds) {
  omp_set_num_threads(1);
  constexpr std::size_t fewest = 4;
  constexpr double rounds = 3;
  CostCurve curve{scaling.what, scaling.size_name, {}, {}};
  curve.expected = scaling.expected;
  std::vector<std::function<void()>> works;
  std::vector<std::vector<double>> seconds;
  const double start = thread_cpu_seconds();
  for (double size = scaling.smallest; size <= scaling.largest; size *= 2) {
    if (works.size() >= fewest) {
      const double next = seconds.back().front() * std::exp2(scaling.expected);
      if ((1 + rounds) * next > cpu_seconds) break;
    }
    works.push_back(scaling.work(size));
    curve.size.push_back(size);
    seconds.push_back({seconds_of(works.back())});
  }
  while (thread_cpu_seconds() - start < cpu_seconds)
    for (std::size_t i = 0; i < works.size(); ++i) seconds[i].push_back(seconds_of(works[i]));
  for (std::vector<double>& rounds_of_size : seconds) curve.cpu_s.push_back(median(rounds_of_size));
  fit_exponent(curve);
  return curve;
}

}  // namespace flatspeckle::bench
