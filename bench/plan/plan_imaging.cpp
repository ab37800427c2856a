// Points found in autocorrelations.

#include "bench/plan/plan_rooms.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/imaged_points.h"

namespace flatspeckle::bench {

namespace {

const std::vector<double> marks{0, 40, 111, 163, 230, 255, 310};

std::vector<Complex> found(const mc::PairPeaks& peaks, std::size_t beam) {
  const auto fit = mc::sparse_search(peaks, {marks.size(), 1, beam});
  return {fit.object.x.begin(), fit.object.x.end()};
}

/// Partial objects beyond a thousand.
PlanRow more_objects(double cpu_seconds) {
  constexpr std::size_t kept = 1000, more = 8000;
  PlanRow row{.per = "search"};
  const mc::PairPeaks peaks = noisy_peaks(marks, 4, 1);
  compare_values(
      row, [&] { return found(peaks, more); }, [&] { return found(peaks, kept); }, 1e-11,
      cpu_seconds);
  return row;
}

}  // namespace

std::vector<PlanCase> imaging_plan_cases() {
  return {
      named("imaging", "more partial objects", "7 points, peaks 4 times the noise", more_objects)};
}

}  // namespace flatspeckle::bench
