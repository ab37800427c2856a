#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/experiments/experiment_kind.h"
#include "apps/sweep/point_journal.h"
#include "apps/sweep/sweep_points.h"
#include "core/result/collected_result.h"
#include "core/run/stopwatch.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::apps {

/// A key that is optimised, continuously between two bounds or over a list of values.
struct SearchAxis {
  std::string key;
  double low = 0, high = 0;
  bool is_log = false;
  /// List of values; empty if the key is continuous between the bounds.
  std::vector<std::string> values = {};

  bool is_choice() const { return !values.empty(); }
  /// Whether the range is a full turn (0 to 2 pi, or -pi to pi), so that both bounds are the same
  /// angle.
  bool is_turn() const;
};

/// The search space: maps points of the search to values of keys.
class SearchAxes {
 public:
  /// Parses the texts of --vary: "key=low:high", "key=low:high:log", or a list of numbers or words
  /// as in a sweep, "key=1,2,3". of: keys of the optimised subcommand. Throws InputError.
  SearchAxes(const std::vector<std::string>& vary, const Keys& of);

  const std::vector<SearchAxis>& axes() const { return axes_; }
  /// dimensions(): number of keys that vary between bounds. choices(): number of combinations of
  /// the listed values of the other keys.
  std::size_t dimensions() const;
  std::size_t choices() const;

  /// Returns the values of the optimised keys at a point of the search, as a list of one point.
  SweepPoints point(const SearchPlace& place) const;
  /// Returns the names of the keys whose value is at a bound, within `tolerance` times the range.
  /// Keys whose range is a full turn have no bounds.
  std::vector<std::string> at_bounds(const SearchPlace& place, double tolerance) const;

 private:
  std::vector<SearchAxis> axes_;
};

/// The objective: a number in a result, named by its dataset and, for arrays, its indices: "total",
/// "sensors/through/total" or "image[3,4]".
class SearchObjective {
 public:
  /// key: maximise or minimise, for error messages. text: value of this key, the objective. Throws
  /// InputError.
  SearchObjective(std::string key, const std::string& text);

  const std::string& text() const { return text_; }
  /// Returns the value of the objective in a result. Throws InputError if the result does not
  /// contain it.
  double of(const CollectedResult& result) const;
  /// Returns the dataset of the result that contains the objective. Throws InputError if there is
  /// none.
  const CollectedDataset& dataset(const CollectedResult& result) const;

 private:
  std::size_t place_in(const CollectedResult& result, const CollectedDataset& set) const;

  std::string key_, text_, path_;
  std::vector<std::size_t> index_;
};

/// Settings of the evaluations.
struct EvaluationSettings {
  bool minimise = false;
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> samples;  ///< number of samples of each of the first evaluations
  /// Time limit, in seconds, after which no evaluation of the search is started.
  std::optional<double> seconds;
  int threads = 1;
};

/// One evaluation of the objective: the point, the effort and the value with its error.
struct Evaluation {
  SweepPoints point;
  SearchEffort effort;
  Measured found;
  double samples = 0, cpu_s = 0;
};

/// Evaluates the objective, at most once for each point and effort. The values are stored in a
/// journal, from which an interrupted search continues.
class Evaluations {
 public:
  /// path, head: file of the journal and its first record, see PointJournal. Throws InputError and
  /// IoError.
  Evaluations(const ExperimentKind& kind, const SearchObjective& objective,
              const EvaluationSettings& settings, const std::filesystem::path& path,
              const JournalHead& head);

  /// Returns the value of the objective at each of these points. Throws Interrupted after a signal,
  /// SearchSpent after the time limit, and InputError if a point is not a valid scene or its result
  /// does not contain the objective.
  std::vector<Measured> measure(const std::vector<SweepPoints>& points, const SearchEffort& effort);
  /// Returns the complete result at a point that was evaluated with draw 2 (see Winner) and this
  /// effort. Throws InputError.
  CollectedResult result(const SweepPoints& point, double samples) const;

  /// Returns all evaluations, in the order in which they were first requested.
  const std::vector<Evaluation>& all() const { return all_; }
  /// kept() returns the number of evaluations in the journal; sync() waits until they are on disk.
  std::size_t kept() const { return journal_.size(); }
  void sync() { journal_.sync(); }
  /// Returns the dataset that contains the objective, without its values.
  const CollectedDataset& dataset() const { return *dataset_; }

 private:
  void run(const std::vector<SweepPoints>& points, const SearchEffort& effort);
  FinishedPoint read(const std::string& name) const { return journal_.read(places_.at(name)); }
  FinishedPoint finished(const PlannedExperiment& planned, const RunState& state,
                         bool keeps_result);
  Measured measured(const FinishedPoint& point) const;
  std::uint64_t samples_of(const BatchJob& job, const SearchEffort& effort) const;

  const ExperimentKind& kind_;
  const SearchObjective& objective_;
  EvaluationSettings settings_;
  /// Positions of the evaluations in the journal, by their names.
  std::unordered_map<std::string, std::uint64_t> places_;
  std::mutex mutex_;  ///< protects places_ while a pool works
  PointJournal journal_;
  std::vector<Evaluation> all_;
  std::set<std::string> known_;
  std::optional<CollectedDataset> dataset_;
  Stopwatch clock_;
};

}  // namespace flatspeckle::apps
