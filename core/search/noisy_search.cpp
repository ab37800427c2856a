#include "core/search/noisy_search.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <memory>
#include <nlopt.h>
#include <numbers>
#include <set>

#include "core/contract.h"

namespace flatspeckle {

std::vector<GroupedSums> without_blocks(const GroupedSums& sums, std::size_t blocks) {
  blocks = std::min(blocks, sums.groups());
  std::vector<double> samples(blocks);
  std::vector<std::vector<Complex>> totals(blocks, std::vector<Complex>(sums.size()));
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const auto own = sums.group_sums(group);
    auto& total = totals[group % blocks];
    std::ranges::transform(own, total, total.begin(), std::plus());
    samples[group % blocks] += sums.group_samples(group);
  }
  std::vector<GroupedSums> without(blocks, GroupedSums(sums.size()));
  for (std::size_t left_out = 0; left_out < blocks; ++left_out)
    for (std::size_t block = 0; block < blocks; ++block)
      if (block != left_out) without[left_out].add(samples[block], totals[block]);
  return without;
}

namespace {

/// Data that NLopt passes to the callback called(). Exceptions are stored in `failure`, because
/// they must not pass through NLopt, a C library.
struct LocalCall {
  const std::function<std::optional<double>(const UnitPlace&)>& value;
  nlopt_opt optimiser = nullptr;
  std::exception_ptr failure = {};
};

double called(unsigned size, const double* at, double*, void* data) {
  LocalCall& call = *static_cast<LocalCall*>(data);
  try {
    if (const auto found = call.value(UnitPlace(at, at + size))) return *found;
  } catch (...) {
    call.failure = std::current_exception();
  }
  nlopt_force_stop(call.optimiser);
  return 0;
}

Measured combined(const Measured& a, const Measured& b, auto&& of) {
  FS_EXPECT(a.without.size() == b.without.size());
  Measured made{of(a.value, b.value)};
  for (std::size_t i = 0; i < a.without.size(); ++i)
    made.without.push_back(of(a.without[i], b.without[i]));
  return made;
}

/// Factor by which the number of samples is increased while differences are not significant.
constexpr double growth = 4;

/// Returns the solution x of x^(d+1) = x + 1, where d is the number of dimensions (sequence of
/// Roberts).
double root_of(std::size_t dimensions) {
  double x = 2;
  for (int i = 0; i < 60; ++i) x = std::pow(1 + x, 1 / static_cast<double>(dimensions + 1));
  return x;
}

/// Box that the points of a scan fill, and the discrete choices at these points. It may extend
/// beyond the unit cube; points outside the cube are moved to its faces.
struct SearchBox {
  UnitPlace low, high;
  std::vector<std::size_t> choices;
};

/// Returns a box that is larger than the unit cube by a margin. Points in the margin are moved to
/// the faces of the cube, where maxima often are.
SearchBox all_of(const SearchTask& task) {
  constexpr double margin = 0.05;
  SearchBox box{UnitPlace(task.dimensions, -margin), UnitPlace(task.dimensions, 1 + margin), {}};
  for (std::size_t choice = 0; choice < task.choices; ++choice) box.choices.push_back(choice);
  return box;
}

/// Returns `count` points that fill the box evenly, except those that `before` contains, and adds
/// them to `before`. Each discrete choice receives consecutive points of the sequence, which also
/// fill the box evenly.
std::vector<SearchPlace> scattered_places(const SearchBox& box, std::size_t count,
                                          std::set<SearchPlace>& before) {
  const std::size_t dimensions = box.low.size();
  const double root = root_of(dimensions);
  std::vector<SearchPlace> places;
  for (std::size_t i = 0; i < count; ++i) {
    SearchPlace place{{}, box.choices[i * box.choices.size() / count]};
    double share = 1;
    for (std::size_t k = 0; k < dimensions; ++k) {
      share /= root;
      const double at = 0.5 + static_cast<double>(i) * share;
      const double within = std::lerp(box.low[k], box.high[k], at - std::floor(at));
      place.at.push_back(std::clamp(within, 0.0, 1.0));
    }
    if (before.insert(place).second) places.push_back(std::move(place));
  }
  return places;
}

/// Returns the distance of two points in the maximum norm; infinite if their discrete choices
/// differ.
double distance(const SearchPlace& a, const SearchPlace& b) {
  if (a.choice != b.choice) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t i = 0; i < a.at.size(); ++i)
    largest = std::max(largest, std::abs(a.at[i] - b.at[i]));
  return largest;
}

bool is_better(const FoundPlace& a, const FoundPlace& b) {
  return a.measured.value > b.measured.value;
}

bool is_away(const FoundPlace& one, const std::vector<FoundPlace>& all, double least) {
  return std::ranges::all_of(
      all, [&](const FoundPlace& other) { return distance(one.place, other.place) > least; });
}

std::vector<FoundPlace> measured_at(const SearchTask& task, const std::vector<SearchPlace>& places,
                                    const SearchEffort& effort) {
  const std::vector<Measured> measured = task.measure(places, effort);
  std::vector<FoundPlace> found;
  for (std::size_t i = 0; i < places.size(); ++i)
    found.push_back({places[i], measured[i], effort.samples});
  return found;
}

/// Returns a box around the best tenth of these points, with a margin. The discrete choices of the
/// box are those of the best tenth, equally often.
SearchBox around_best(std::vector<FoundPlace> places) {
  constexpr double margin = 0.1;
  const std::size_t count = std::max(places.size() / 10, places.front().place.at.size() + 1);
  std::ranges::stable_sort(places, is_better);
  places.resize(std::min(count, places.size()));
  SearchBox box{places.front().place.at, places.front().place.at, {}};
  for (const FoundPlace& one : places) {
    box.choices.push_back(one.place.choice);
    for (std::size_t k = 0; k < box.low.size(); ++k) {
      box.low[k] = std::min(box.low[k], one.place.at[k]);
      box.high[k] = std::max(box.high[k], one.place.at[k]);
    }
  }
  for (std::size_t k = 0; k < box.low.size(); ++k) {
    const double more = margin + margin * (box.high[k] - box.low[k]);
    box.low[k] -= more;
    box.high[k] += more;
  }
  std::ranges::sort(box.choices);
  return box;
}

/// Local search that starts at one of the points of the scan and proceeds in rounds.
class RefinedSearch {
 public:
  RefinedSearch(const SearchTask& task, const SearchSettings& settings, FoundPlace start,
                double step)
      : task_(&task), settings_(&settings), best_(std::move(start)), step_(step) {}

  const FoundPlace& best() const { return best_; }
  double step() const { return step_; }
  bool has_ended() const { return ended_; }

  /// Makes one round of the search: a local search with a fixed number of samples, after which the
  /// step or the number of samples is adapted to the noise.
  void go_on() {
    // last step of the local search of a round, relative to its first step
    constexpr double finest = 1.0 / 8;
    const int most = 8 * static_cast<int>(task_->dimensions) + 8;
    around_ = measured_at(*task_, {best_.place}, {best_.samples});
    local_search(best_.place.at, step_, finest * step_, most, [&](const UnitPlace& at) {
      const auto found = measured_at(*task_, {{at, best_.place.choice}}, {best_.samples});
      around_.push_back(found.front());
      return std::optional(found.front().measured.value);
    });
    best_ = *std::ranges::min_element(around_, is_better);
    judge();
  }

 private:
  void judge() {
    const auto [seen, noise] = typical();
    if (seen >= least_seen) {
      step_ /= noise > 0 ? 2 : 4;
    } else {  // with a smaller step, noise would dominate the differences
      ended_ = noise <= settings_->target_error / 2 * std::abs(best_.measured.value) ||
               best_.samples * growth > settings_->most_samples;
      if (!ended_) best_.samples *= growth;
    }
    ended_ = ended_ || step_ < settings_->tolerance;
  }

  /// Returns the median, over successive points of the last round, of the difference in standard
  /// errors, and the median of the standard error. The best point is left out, because it was
  /// selected by its value and would seem to differ from the others even in pure noise.
  std::pair<double, double> typical() const {
    std::vector<double> seen{}, noise{};
    const FoundPlace* before = nullptr;
    for (const FoundPlace& one : around_) {
      if (one.place == best_.place) continue;
      if (before) {
        const Difference apart = difference(before->measured, one.measured);
        seen.push_back(apart.error == 0 ? least_seen : std::abs(apart.significance()));
        noise.push_back(apart.error);
      }
      before = &one;
    }
    if (seen.empty()) return {least_seen, 0};
    return {median(seen), median(noise)};
  }

  static double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
  }

  static constexpr double least_seen = 2;

  const SearchTask* task_;
  const SearchSettings* settings_;
  FoundPlace best_;
  double step_;
  std::vector<FoundPlace> around_;
  bool ended_ = false;
};

/// Returns the `count` best points of the scan, any two of which are more than `apart` from each
/// other.
std::vector<FoundPlace> starts_of(std::vector<FoundPlace> scattered, std::size_t count,
                                  double apart) {
  std::ranges::stable_sort(scattered, is_better);
  std::vector<FoundPlace> starts;
  for (FoundPlace& place : scattered)
    if (starts.size() < count && is_away(place, starts, apart)) starts.push_back(std::move(place));
  return starts;
}

std::string summary_of(const FoundPlace& best, const SearchTask& task) {
  char text[80];
  std::snprintf(text, sizeof text, "best %.4g +- %.2g",
                task.negated ? -best.measured.value : best.measured.value, error(best.measured));
  return text;
}

/// Removes searches whose best value is significantly below the best value of all searches, and
/// searches that have arrived at the same point as a better search.
void drop_losers(std::vector<RefinedSearch>& searches) {
  constexpr double sure = 3;
  std::ranges::stable_sort(searches, [](const RefinedSearch& a, const RefinedSearch& b) {
    return is_better(a.best(), b.best());
  });
  const RefinedSearch first = searches.front();
  std::vector<RefinedSearch> kept;
  for (const RefinedSearch& search : searches) {
    const double lead = first.best().measured.value - search.best().measured.value;
    const double noise = std::hypot(error(first.best().measured), error(search.best().measured));
    const bool is_twin = std::ranges::any_of(kept, [&](const RefinedSearch& other) {
      return distance(other.best().place, search.best().place) < 2 * search.step();
    });
    if (kept.empty() || (!is_twin && lead <= sure * noise)) kept.push_back(search);
  }
  searches = std::move(kept);
}

void refine(std::vector<RefinedSearch>& searches, const SearchTask& task) {
  while (std::ranges::any_of(searches, [](const RefinedSearch& one) { return !one.has_ended(); })) {
    for (RefinedSearch& search : searches)
      if (!search.has_ended()) search.go_on();
    drop_losers(searches);
    task.report(std::to_string(searches.size()) +
                (searches.size() == 1 ? " search, " : " searches, ") +
                summary_of(searches.front().best(), task));
  }
}

/// Runs `work`; returns false if `work` has ended with SearchSpent, because the budget was spent.
template <class Work>
bool until_spent(const Work& work) {
  try {
    work();
    return true;
  } catch (const SearchSpent&) {
    return false;
  }
}

}  // namespace

void local_search(const UnitPlace& start, double first, double last, int most,
                  const std::function<std::optional<double>(const UnitPlace&)>& value) {
  const auto size = static_cast<unsigned>(start.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> made(
      nlopt_create(size == 1 ? NLOPT_LN_NELDERMEAD : NLOPT_LN_BOBYQA, size), nlopt_destroy);
  nlopt_opt optimiser = made.get();
  LocalCall call{value, optimiser};
  nlopt_set_max_objective(optimiser, called, &call);
  nlopt_set_lower_bounds1(optimiser, 0);
  nlopt_set_upper_bounds1(optimiser, 1);
  nlopt_set_initial_step1(optimiser, first);
  nlopt_set_xtol_abs1(optimiser, last);
  nlopt_set_maxeval(optimiser, most);
  UnitPlace at = start;
  double found = 0;
  // The returned status is not needed, because the caller's function `value` has recorded all
  // values.
  nlopt_optimize(optimiser, at.data(), &found);
  if (call.failure) std::rethrow_exception(call.failure);
}

double error(const Measured& one) {
  const auto blocks = static_cast<double>(one.without.size());
  if (one.without.empty()) return 0;
  if (one.without.size() == 1) return std::numeric_limits<double>::infinity();
  double mean = 0, square = 0;
  for (const double value : one.without) mean += value / blocks;
  for (const double value : one.without) square += (value - mean) * (value - mean);
  return std::sqrt(square * (blocks - 1) / blocks);
}

double Difference::significance() const {
  return value == 0 ? 0 : value / error;
}

double Difference::confidence() const {
  return std::erfc(-significance() / std::numbers::sqrt2) / 2;
}

Difference difference(const Measured& a, const Measured& b) {
  const Measured made = combined(a, b, [](double x, double y) { return x - y; });
  return {made.value, error(made)};
}

Measured ratio(const Measured& a, const Measured& b) {
  return combined(a, b, [](double x, double y) { return x / y; });
}

SearchEnd noisy_search(const SearchTask& task, const SearchSettings& settings) {
  const std::size_t count = std::max(settings.scattered, std::size_t{2});
  std::set<SearchPlace> tried;
  auto places = measured_at(task, scattered_places(all_of(task), count, tried), {});
  SearchEnd end;
  end.finished = until_spent([&] {
    const auto near =
        measured_at(task, scattered_places(around_best(places), count / 2, tried), {});
    places.insert(places.end(), near.begin(), near.end());
  });
  const double of_each = static_cast<double>(count) / static_cast<double>(task.choices);
  const double apart = std::pow(of_each, -1 / static_cast<double>(task.dimensions));
  std::vector<RefinedSearch> searches;
  for (const FoundPlace& start : starts_of(places, settings.starts, apart))
    searches.emplace_back(task, settings, start, std::min(0.5 * apart, 0.25));
  task.report(std::to_string(places.size()) + " scattered places, " +
              summary_of(searches.front().best(), task));
  end.finished = end.finished && until_spent([&] { refine(searches, task); });
  for (const RefinedSearch& search : searches) end.best.push_back(search.best());
  std::ranges::stable_sort(end.best, is_better);
  if (end.best.size() > 1) return end;
  const auto others = starts_of(places, count, apart);
  const auto other = std::ranges::find_if(
      others, [&](const FoundPlace& one) { return is_away(one, end.best, apart / 2); });
  if (other != others.end()) end.best.push_back(*other);
  return end;
}

namespace {

double relative_error_of(const FoundPlace& one) {
  return error(one.measured) / std::abs(one.measured.value);
}

std::vector<FoundPlace> measured_again(const SearchTask& task, const std::vector<FoundPlace>& found,
                                       const SearchEffort& effort) {
  std::vector<SearchPlace> places;
  for (const FoundPlace& one : found) places.push_back(one.place);
  return measured_at(task, places, effort);
}

/// Returns the two best of these points, best first, from new measurements (draw 1). The number of
/// samples is increased until the difference of the two is significant or its error is below half
/// the target error.
std::vector<FoundPlace> two_best(const SearchTask& task, const SearchSettings& settings,
                                 const std::vector<FoundPlace>& found) {
  constexpr double sure = 3;
  for (double samples = growth;; samples *= growth) {
    auto again = measured_again(task, found, {samples, 1});
    std::ranges::stable_sort(again, is_better);
    if (again.size() == 1) return again;
    again.resize(2);
    const Difference lead = difference(again[0].measured, again[1].measured);
    const bool is_resolved = lead.value >= sure * lead.error;
    const double size = std::abs(again[0].measured.value);
    if (is_resolved || lead.error <= settings.target_error / 2 * size ||
        samples * growth > settings.most_samples)
      return again;
  }
}

}  // namespace

Winner chosen_winner(const SearchTask& task, const SearchSettings& settings,
                     const std::vector<FoundPlace>& found) {
  const auto two = two_best(task, settings, found);
  double samples = two.front().samples;
  for (;;) {
    const auto fresh = measured_again(task, two, {samples, 2});
    Winner winner{fresh.front(), fresh.back()};
    winner.lead = difference(winner.best.measured, winner.runner_up.measured);
    const double over = relative_error_of(winner.best) / settings.target_error;
    winner.reached = !(over > 1);
    if (winner.reached || samples >= settings.most_samples) return winner;
    const double needed = std::isfinite(over) ? 1.1 * over * over : growth;
    samples = std::min(std::ceil(samples * std::max(needed, 1.2)), settings.most_samples);
  }
}

}  // namespace flatspeckle
