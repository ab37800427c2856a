#include <cmath>

#include "bench/error/error_modules.h"
#include "bench/scenes/wobbling_beam.h"

namespace flatspeckle::bench {

namespace {

/// Error of the largest power and its time, for searches to this relative error of the power.
ErrorPoint search_point(double target) {
  return rms_point(8, [=](unsigned seed) {
    const WobblingBeam beam{.seed = seed};
    return timed_run(1 / (target * target), [&] {
      const SearchTask task = beam.task();
      const SearchSettings settings{.target_error = target};
      const Winner winner = chosen_winner(task, settings, noisy_search(task, settings).best);
      return std::pow(winner.best.measured.value / beam.largest_power() - 1, 2);
    });
  });
}

ErrorCurve by_search(double cpu_seconds) {
  ErrorCurve curve{
      "optimise, detector and beam", "search", "closed form of the largest power", 0, {}};
  measure_points(curve, cpu_seconds,
                 [target = 0.08]() mutable { return search_point(target /= 2); });
  return curve;
}

}  // namespace

std::vector<ErrorRun> search_error_runs() {
  return {{"optimise, detector and beam", "search", by_search, false}};
}

}  // namespace flatspeckle::bench
