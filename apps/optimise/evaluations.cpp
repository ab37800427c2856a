#include "apps/optimise/evaluations.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <set>
#include <sstream>

#include "apps/experiments/experiment_kind.h"
#include "apps/sweep/sweep_points.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "core/result/provenance.h"
#include "core/run/interrupt.h"
#include "core/run/run_merger.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::apps {

namespace {

constexpr const char* forms =
    "must be key=low:high with low < high, key=low:high:log with bounds above 0, or a list of "
    "values key=1,2,3";

[[noreturn]] void refuse(const std::string& text) {
  throw InputError("vary", text, forms);
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char letter : text)
    if (letter == ':')
      parts.emplace_back();
    else
      parts.back() += letter;
  return parts;
}

/// Whether a text with these parts between colons gives two bounds: low:high or low:high:log. With
/// a number as third part it is a list of values.
bool is_between(const std::vector<std::string>& parts) {
  return parts.size() == 2 || (parts.size() == 3 && trimmed(parts[2]) == "log");
}

SearchAxis between(const Keys& of, const std::string& text, const std::string& name,
                   const std::vector<std::string>& parts) {
  const Key& key = varied_key(of, name, text);
  if (!key.is_number()) refuse(text);
  const auto low = written_number(parts[0], key.number_unit());
  const auto high = written_number(parts[1], key.number_unit());
  const bool is_log = parts.size() == 3;
  if (!low || !high || !(*low < *high) || (is_log && *low <= 0) || !std::isfinite(*high - *low))
    refuse(text);
  if (!key.is_whole()) return {name, *low, *high, is_log};
  constexpr double most = 64;
  if (*high - *low > most || is_log)
    throw InputError("vary", text,
                     "must have at most 64 whole numbers between the bounds, and no log, because "
                     "each number is tried");
  SearchAxis choice{name};
  for (double value = std::ceil(*low); value <= *high; ++value)
    choice.values.push_back(number_text(value));
  return choice;
}

SearchAxis axis_of(const Keys& of, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse(text);
  const std::string name = text.substr(0, equals);
  const auto parts = parts_of(text.substr(equals + 1));
  if (is_between(parts)) return between(of, text, name, parts);
  SearchAxis choice{name};
  choice.values = varied_axis(of, text).values.texts();
  return choice;
}

double value_at(const SearchAxis& axis, double share) {
  const double value = axis.is_log ? axis.low * std::pow(axis.high / axis.low, share)
                                   : axis.low + share * (axis.high - axis.low);
  return std::clamp(value, axis.low, axis.high);
}

bool is_plain(const CollectedDataset& set) {
  return !set.is_scale && !set.name.ends_with("_error") && !set.name.ends_with("_rare") &&
         !set.name.starts_with("invariants/") &&
         std::holds_alternative<std::vector<double>>(set.values);
}

/// Returns the names of the values in the result that can serve as the objective, scalars first,
/// for error messages.
std::string names_in(const CollectedResult& result) {
  constexpr std::size_t most = 12;
  std::vector<std::string> names;
  for (const bool is_single : {true, false})
    for (const CollectedDataset& set : result.datasets)
      if (is_plain(set) && (set.count() == 1) == is_single)
        names.push_back(set.name + (is_single ? "" : "[i]"));
  if (names.size() > most) names.resize(most);
  return join_texts(names, " ");
}

std::size_t extent(const CollectedResult& result, const Axis& axis) {
  if (const auto* count = std::get_if<std::size_t>(&axis)) return *count;
  return result.find(std::get<std::string>(axis))->count();
}

constexpr std::uint64_t winner_draw = 2;

std::string name_of(const SweepPoints& point, const SearchEffort& effort) {
  return point.name(0) + "_effort=" + number_text(effort.samples) +
         "_draw=" + std::to_string(effort.draw);
}

const std::vector<double>& numbers(const CollectedResult& result, const char* name) {
  return std::get<std::vector<double>>(result.find(name)->values);
}

}  // namespace

bool SearchAxis::is_turn() const {
  constexpr double turn = 2 * std::numbers::pi, as_written = 1e-4 * turn;
  const bool is_centred = std::abs(low + high) < as_written;
  return !is_log && (low == 0 || is_centred) && std::abs(high - low - turn) < as_written;
}

SearchAxes::SearchAxes(const std::vector<std::string>& vary, const Keys& of) {
  std::set<std::string> seen;
  for (const std::string& text : vary) {
    axes_.push_back(axis_of(of, text));
    if (!seen.insert(axes_.back().key).second)
      throw InputError("vary", text, axes_.back().key + " is varied twice; leave one out");
    if (axes_.back().key == "seed")
      throw InputError("vary", text, "seed cannot be optimised; sweep runs several seeds");
  }
  if (dimensions() == 0)
    throw InputError(
        "vary: must have at least one key between bounds, key=low:high; use sweep for lists of "
        "values");
}

std::size_t SearchAxes::dimensions() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(axes_, [](const SearchAxis& axis) { return !axis.is_choice(); }));
}

std::size_t SearchAxes::choices() const {
  std::size_t choices = 1;
  for (const SearchAxis& axis : axes_)
    if (axis.is_choice()) choices *= axis.values.size();
  return choices;
}

SweepPoints SearchAxes::point(const SearchPlace& place) const {
  SweepPoints point{{}, true};
  auto share = place.at.begin();
  std::size_t choice = place.choice;
  for (const SearchAxis& axis : axes_) {
    if (!axis.is_choice()) {
      point.axes.push_back({axis.key, {number_text(value_at(axis, *share++))}});
      continue;
    }
    point.axes.push_back({axis.key, {axis.values[choice % axis.values.size()]}});
    choice /= axis.values.size();
  }
  return point;
}

std::vector<std::string> SearchAxes::at_bounds(const SearchPlace& place, double tolerance) const {
  std::vector<std::string> keys;
  auto share = place.at.begin();
  for (const SearchAxis& axis : axes_) {
    if (axis.is_choice()) continue;
    if (!axis.is_turn() && std::min(*share, 1 - *share) <= tolerance) keys.push_back(axis.key);
    ++share;
  }
  return keys;
}

SearchObjective::SearchObjective(std::string key, const std::string& text)
    : key_(std::move(key)), text_(text), path_(text.substr(0, text.find('['))) {
  if (path_ == text) return;
  std::string inside = text.substr(path_.size() + 1);
  const bool is_closed = inside.ends_with(']');
  if (is_closed) inside.pop_back();
  std::istringstream numbers(inside);
  for (std::string number; std::getline(numbers, number, ',');) {
    const auto whole = read_whole_number(std::string(trimmed(number)));
    if (!whole || *whole < 0) break;
    index_.push_back(static_cast<std::size_t>(*whole));
  }
  const auto commas = static_cast<std::size_t>(std::ranges::count(inside, ','));
  if (!is_closed || index_.size() != commas + 1)
    throw InputError(key_, text, "must be a dataset of the result, such as total or image[3,4]");
}

const CollectedDataset& SearchObjective::dataset(const CollectedResult& result) const {
  const CollectedDataset* const set = result.find(path_);
  if (set == nullptr || !is_plain(*set))
    throw InputError(key_, text_,
                     "must be a real number of the result, such as " + names_in(result));
  return *set;
}

std::size_t SearchObjective::place_in(const CollectedResult& result,
                                      const CollectedDataset& set) const {
  if (index_.empty() && set.count() == 1) return 0;
  std::size_t place = 0;
  std::vector<std::string> extents;
  bool fits = index_.size() == set.axes.size();
  for (std::size_t i = 0; i < set.axes.size(); ++i) {
    const std::size_t count = extent(result, set.axes[i]);
    extents.push_back(std::to_string(count));
    fits = fits && index_[i] < count;
    if (fits) place = place * count + index_[i];
  }
  if (!fits)
    throw InputError(key_, text_,
                     path_ + " has " + join_texts(extents, " x ") +
                         " numbers: select one by its indices, such as " + path_ + "[0" +
                         (extents.size() > 1 ? ",0]" : "]"));
  return place;
}

double SearchObjective::of(const CollectedResult& result) const {
  const CollectedDataset& set = dataset(result);
  return std::get<std::vector<double>>(set.values)[place_in(result, set)];
}

Evaluations::Evaluations(const ExperimentKind& kind, const SearchObjective& objective,
                         const EvaluationSettings& settings, const std::filesystem::path& path,
                         const JournalHead& head)
    : kind_(kind),
      objective_(objective),
      settings_(settings),
      journal_(path, head, "search", [this](const std::string& name, std::uint64_t place) {
        places_.emplace(name, place);
      }) {}

std::vector<Measured> Evaluations::measure(const std::vector<SweepPoints>& points,
                                           const SearchEffort& effort) {
  std::vector<SweepPoints> missing;
  std::set<std::string> requested;
  for (const SweepPoints& point : points) {
    const std::string name = name_of(point, effort);
    if (!places_.contains(name) && requested.insert(name).second) missing.push_back(point);
  }
  if (!missing.empty()) run(missing, effort);
  std::vector<Measured> found;
  for (const SweepPoints& point : points) {
    const std::string name = name_of(point, effort);
    const FinishedPoint finished = read(name);
    found.push_back(measured(finished));
    if (!dataset_) dataset_ = *finished.result.find("of");
    if (known_.insert(name).second)
      all_.push_back({point, effort, found.back(), finished.samples, finished.cpu_s});
  }
  return found;
}

CollectedResult Evaluations::result(const SweepPoints& point, double samples) const {
  CollectedResult result = read(name_of(point, {samples, winner_draw})).result;
  std::erase_if(result.datasets, [](const CollectedDataset& set) {
    return set.name == "found" || set.name == "without" || set.name == "of";
  });
  return result;
}

/// Returns the number of samples of an evaluation: effort.samples times the number of samples of
/// the first evaluations. These have at least 32 batches, which are needed to estimate errors.
std::uint64_t Evaluations::samples_of(const BatchJob& job, const SearchEffort& effort) const {
  constexpr double fewest = 32;
  const double batches =
      std::max(fewest, static_cast<double>(settings_.samples.value_or(0)) / job.samples_per_batch);
  return static_cast<std::uint64_t>(std::ceil(batches * effort.samples) * job.samples_per_batch);
}

void Evaluations::run(const std::vector<SweepPoints>& points, const SearchEffort& effort) {
  if (settings_.seconds && effort.draw == 0 && clock_.seconds() > *settings_.seconds)
    throw SearchSpent{};
  struct Open {
    std::unique_ptr<Experiment> experiment;
    PlannedExperiment planned;
    RunState state;
  };
  std::vector<std::unique_ptr<Open>> open(points.size());
  RunList list;
  list.count = points.size();
  list.open = [&](std::size_t i) -> std::optional<OpenRun> {
    auto made = std::make_unique<Open>();
    made->experiment = at_point(points[i], 0, [&] {
      return kind_.run([&](const Keys& keys) { set_point(points[i], 0, keys); }, {},
                       settings_.seed + effort.draw);
    });
    made->planned = plan_at(points[i], 0, *made->experiment);
    const BatchJob& job = made->planned.batches;
    const std::uint64_t samples = job.one_by_one ? fewest_batches : samples_of(job, effort);
    open[i] = std::move(made);
    return OpenRun{job, StopRule{samples, {}, {}}, &open[i]->state};
  };
  list.ended = [&](std::size_t i, StopReason) {
    const std::string name = name_of(points[i], effort);
    const FinishedPoint found = at_point(points[i], 0, [&] {
      return finished(open[i]->planned, open[i]->state, effort.draw == winner_draw);
    });
    const std::uint64_t place = journal_.add(name, found);
    const std::lock_guard lock(mutex_);
    places_.emplace(name, place);
    open[i].reset();
  };
  list.checkpoint = [](std::size_t) {};
  const PoolEnd end = run_pool(list, PoolOptions{{}, settings_.threads, ""});
  if (end.reason == StopReason::interrupted) throw Interrupted{};
}

/// Returns the finished evaluation for the journal: the objective, and its values without each
/// block of batches (for the jackknife). If keeps_result is true, as for the best point, it also
/// contains the full result.
FinishedPoint Evaluations::finished(const PlannedExperiment& planned, const RunState& state,
                                    bool keeps_result) {
  constexpr std::size_t blocks = 32;
  const auto result_of = [&](const GroupedSums& sums) {
    CollectedResult result;
    ResultFile collecting(result);
    planned.write(collecting, sums, false);
    return result;
  };
  CollectedResult result = result_of(state.sums);
  std::vector<double> found{objective_.of(result)}, without;
  if (!planned.batches.one_by_one)
    for (const GroupedSums& sums : without_blocks(state.sums, blocks))
      without.push_back(objective_.of(result_of(sums)));
  FinishedPoint point{.plan = planned.plan,
                      .started = utc_now(),
                      .samples = planned.batches.one_by_one ? 1 : state.sums.total_samples(),
                      .cpu_s = state.cpu_s,
                      .wall_s = state.wall_s,
                      .result = {}};
  CollectedDataset of = objective_.dataset(result);
  of.name = "of", of.axes.clear(), of.values = std::vector<double>{};
  if (keeps_result) point.result = std::move(result);
  point.result.datasets.push_back(std::move(of));
  point.result.datasets.push_back({"found", false, {}, "", "", std::move(found)});
  point.result.datasets.push_back({"without", false, {}, "", "", std::move(without)});
  return point;
}

/// Returns the measurement for the search, which maximises: the objective, times -1 if it is to be
/// minimised.
Measured Evaluations::measured(const FinishedPoint& point) const {
  const double sign = settings_.minimise ? -1 : 1;
  Measured found{sign * numbers(point.result, "found").front()};
  for (const double value : numbers(point.result, "without")) found.without.push_back(sign * value);
  return found;
}

}  // namespace flatspeckle::apps
