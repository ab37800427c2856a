// Comparisons for searches: measurements far from the maximum.

#include <algorithm>
#include <cmath>

#include "bench/plan/plan_timing.h"
#include "bench/scenes/wobbling_beam.h"

namespace flatspeckle::bench {

namespace {

constexpr double accuracy = 0.02;  // of the power

/// Returns the mean power in closed form at the found place, relative to the largest.
std::vector<Complex> quality(const WobblingBeam& beam, const UnitPlace& at) {
  return {beam.mean_power(at) / beam.largest_power()};
}

/// Compares a grid of 33 x 33 places, each measured to the target error, with a search.
TwoAlternatives places_far_from_the_maximum(bool) {
  const WobblingBeam beam;
  const SearchTask task = beam.task();
  const auto by_grid = [=] {
    constexpr int side = 33;
    constexpr double samples = 32;  // reaches the target error at the maximum
    std::vector<SearchPlace> places;
    for (int i = 0; i < side * side; ++i)
      places.push_back({{(i % side) / (side - 1.0), static_cast<double>(i / side) / (side - 1.0)}});
    const auto measured = task.measure(places, {samples});
    const auto best =
        std::max_element(measured.begin(), measured.end(),
                         [](const Measured& a, const Measured& b) { return a.value < b.value; });
    return quality(beam, places[static_cast<std::size_t>(best - measured.begin())].at);
  };
  const auto by_search = [=] {
    const SearchSettings settings{.scattered = 32, .target_error = accuracy};
    const Winner winner = chosen_winner(task, settings, noisy_search(task, settings).best);
    return quality(beam, winner.best.place.at);
  };
  return {by_grid, by_search};
}

}  // namespace

std::vector<PlanCase> search_plan_cases() {
  return {case_of_values({"search", "places far from the maximum", "beam that wobbles", "search"},
                         accuracy, places_far_from_the_maximum)};
}

}  // namespace flatspeckle::bench
