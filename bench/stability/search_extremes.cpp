#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "bench/scenes/wobbling_beam.h"
#include "bench/stability/extreme_rows.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::bench {

namespace {

Winner winner_of(const SearchTask& task, const SearchSettings& settings) {
  return chosen_winner(task, settings, noisy_search(task, settings).best);
}

/// Makes the search for the largest value of a function without noise.
SearchTask exact(std::size_t dimensions, const std::function<double(const UnitPlace&)>& value) {
  SearchTask task{.dimensions = dimensions, .measure = {}};
  task.measure = [value](const std::vector<SearchPlace>& places, const SearchEffort&) {
    std::vector<Measured> found;
    for (const SearchPlace& place : places) found.push_back({value(place.at)});
    return found;
  };
  return task;
}

/// Returns the largest distance, in a coordinate, between the found and the true maximum of a hill.
Finding top_of_hill(const UnitPlace& top, double width, double scale) {
  const auto hill = [=](const UnitPlace& at) {
    double square = 0;
    for (std::size_t i = 0; i < at.size(); ++i) square += std::pow((at[i] - top[i]) / width, 2);
    return scale * std::exp(-square / 2);
  };
  const Winner winner = winner_of(exact(top.size(), hill), {});
  double off = 0;
  for (std::size_t i = 0; i < top.size(); ++i)
    off = larger(off, std::abs(winner.best.place.at[i] - top[i]));
  return {off, 5e-3};
}

/// Searches where all values are equal: no place may lead another.
Finding nothing_to_find() {
  const Winner winner = winner_of(exact(2, [](const UnitPlace&) { return 3.0; }), {});
  return {std::abs(winner.lead.value) + std::abs(winner.best.measured.value - 3), 0};
}

/// Compares the value of the winner with that of its place in closed form.
Finding value_of_winner(double wobble, double scale) {
  const WobblingBeam beam{.width = 0.02, .wobble = wobble, .scale = scale};
  const SearchSettings settings{.scattered = 32, .target_error = 0.3, .most_samples = 64};
  const Winner winner = winner_of(beam.task(), settings);
  const Measured& measured = winner.best.measured;
  return in_errors(measured.value, error(measured), beam.mean_power(winner.best.place.at),
                   std::numeric_limits<double>::infinity());
}

}  // namespace

void search_extremes(ExtremeRows& rows) {
  const std::string place = "distance from the maximum, as a fraction of the range";
  for (const double scale : {1e-150, 1e-12, 1e150})
    rows.add("hill of height " + short_number(scale), place, top_of_hill, UnitPlace{0.3, 0.6}, 0.2,
             scale);
  rows.add("hill in a corner", place, top_of_hill, UnitPlace{1, 0}, 0.2, 1);
  rows.add("hill of 1/20 of the range", place, top_of_hill, UnitPlace{0.71, 0.13}, 0.05, 1);
  rows.add("hill in five dimensions", place, top_of_hill, UnitPlace{0.3, 0.6, 0.5, 0.4, 0.7}, 0.4,
           1);
  rows.add("equal values everywhere", "no lead", nothing_to_find);
  for (const double scale : {1e-100, 1.0, 1e100})
    rows.add("noise of 15 times the values, values of " + short_number(scale),
             "value of the selected place, in standard errors", value_of_winner, 0.3, scale);
}

}  // namespace flatspeckle::bench
