#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/experiments/experiment_family.h"
#include "apps/sweep/point_journal.h"
#include "apps/sweep/sweep_points.h"
#include "core/result/collected_result.h"
#include "core/run/stopwatch.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::apps {

/// A key that is searched over: between two bounds, or one of some values.
struct SearchAxis {
  std::string key;
  double low = 0, high = 0;
  bool is_log = false;
  std::vector<std::string> values = {};  ///< empty: between the bounds

  bool is_choice() const { return !values.empty(); }
  /// From 0 to 2 pi or -pi to pi, as of a phase: the bounds are the same place.
  bool is_turn() const;
};

/// What is searched: places of the search, and the values of keys that they stand for.
class SearchAxes {
 public:
  /// Of "key=low:high", "key=low:high:log" and of what a sweep takes: "key=1,2,3" or words. Keys of
  /// `of`. Throws InputError.
  SearchAxes(const std::vector<std::string>& vary, const Keys& of);

  const std::vector<SearchAxis>& axes() const { return axes_; }
  /// Of keys between bounds, and of combinations of the others.
  std::size_t dimensions() const;
  std::size_t choices() const;

  /// The values of the keys there, one for each axis.
  SweepPoints point(const SearchPlace& place) const;
  /// Keys that are there at a bound of theirs, by no more than this share of their range; not
  /// phases, which have none.
  std::vector<std::string> at_bounds(const SearchPlace& place, double tolerance) const;

 private:
  std::vector<SearchAxis> axes_;
};

/// A number of a result: "total", "sensors/through/total", "image[3,4]".
class SearchObjective {
 public:
  /// Throws InputError, naming the key that asks for it.
  SearchObjective(std::string key, const std::string& text);

  const std::string& text() const { return text_; }
  /// Throws InputError where the result has no such number.
  double of(const CollectedResult& result) const;
  /// The dataset. Throws InputError.
  const CollectedDataset& dataset(const CollectedResult& result) const;

 private:
  std::size_t place_in(const CollectedResult& result, const CollectedDataset& set) const;

  std::string key_, text_, path_;
  std::vector<std::size_t> index_;
};

/// How results are measured.
struct EvaluationSettings {
  bool minimise = false;
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> samples;  ///< of the first measurements
  std::optional<double> seconds;         ///< after which no new ones are begun
  int threads = 1;
};

/// One of them: where, with how much effort, and what was found.
struct Evaluation {
  SweepPoints point;
  SearchEffort effort;
  Measured found;
  double samples = 0, cpu_s = 0;
};

/// Numbers of results, measured once each: a journal keeps them from one call of the program to the
/// next.
class Evaluations {
 public:
  /// path, head: of the journal, as PointJournal. Throws InputError, IoError.
  Evaluations(const ExperimentFamily& family, const SearchObjective& objective,
              const EvaluationSettings& settings, const std::filesystem::path& path,
              const JournalHead& head);

  /// Of the number at each of these points. Throws Interrupted, SearchSpent once the time is up,
  /// and InputError where a point is no scene or its result has no such number.
  std::vector<Measured> measure(const std::vector<SweepPoints>& points, const SearchEffort& effort);
  /// What a point's result holds, of those that were measured with draw 2. Throws InputError.
  CollectedResult result(const SweepPoints& point, double samples) const;

  /// In the order in which they were asked for first.
  const std::vector<Evaluation>& all() const { return all_; }
  /// How many the journal holds, and waits until the disk has them.
  std::size_t kept() const { return journal_.size(); }
  void sync() { journal_.sync(); }
  /// The dataset that the number is in.
  const CollectedDataset& dataset() const { return *dataset_; }

 private:
  void run(const std::vector<SweepPoints>& points, const SearchEffort& effort);
  FinishedPoint read(const std::string& name) const { return journal_.read(places_.at(name)); }
  FinishedPoint finished(const PlannedExperiment& planned, const RunState& state,
                         bool keeps_result);
  Measured measured(const FinishedPoint& point) const;
  std::uint64_t samples_of(const BatchJob& job, const SearchEffort& effort) const;

  const ExperimentFamily& family_;
  const SearchObjective& objective_;
  EvaluationSettings settings_;
  std::unordered_map<std::string, std::uint64_t> places_;  ///< in the journal, by their names
  std::mutex mutex_;                                       ///< of places_, while a pool works
  PointJournal journal_;
  std::vector<Evaluation> all_;
  std::set<std::string> known_;
  std::optional<CollectedDataset> dataset_;
  Stopwatch clock_;
};

}  // namespace flatspeckle::apps
