#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/experiments/experiment_sweep.h"
#include "apps/experiments/point_journal.h"
#include "core/run/stopwatch.h"
#include "core/session/shard_folder.h"

namespace flatspeckle::apps {

/// Journals of points in these folders, by any share of any sweep.
std::vector<std::filesystem::path> journals_in(const std::string& folder);

/// What folders hold of a sweep: finished points of all its shares, and of this share those at
/// work. For any thread.
class PointStore {
 public:
  /// What is there, to read. Journals of other sweeps are left out, with a warning.
  PointStore(const ExperimentSweep& sweep, const std::vector<std::string>& folders);
  /// The same, and to go on with as this share. Throws InputError where its own journal is of
  /// another sweep, or of an earlier one that is not to be resumed.
  PointStore(const ExperimentSweep& sweep, const std::string& folder);

  bool has(std::size_t point) const;
  /// Of the sweep's points.
  std::size_t finished() const { return finished_; }
  /// Each that is finished, in their order.
  void for_each(const std::function<void(std::size_t point, const FinishedPoint&)>& use) const;

  void add(std::size_t point, const FinishedPoint& finished);
  /// Of a point at work; `size` sums. Empty where there is none.
  RunState unfinished(std::size_t point, std::size_t size);
  void save_unfinished(std::size_t point, const Provenance& made, const RunState& state);
  void sync() { journals_.front()->sync(); }

  /// All of this sweep, and each folder if nothing else is in it.
  void remove();

 private:
  void open_others(const std::string& folder, const std::filesystem::path& own);
  PointJournal::Found notes();
  void note(std::size_t point, std::size_t journal, std::uint64_t place);
  std::string name_of(std::size_t point) const { return sweep_.points().name(point); }
  std::set<std::string> ours_of(const std::set<std::string>& names) const;

  const ExperimentSweep& sweep_;
  std::string identity_;
  std::vector<std::string> folders_;
  std::unique_ptr<ShardFolder> folder_;
  std::vector<std::unique_ptr<PointJournal>> journals_;  ///< this share's first
  std::vector<std::filesystem::path> paths_;
  ScratchNumbers places_;  ///< of the points, with the number of the journal
  std::size_t finished_ = 0;
  mutable std::mutex mutex_;
  Stopwatch clock_;
  std::atomic<double> synced_ = 0;
};

}  // namespace flatspeckle::apps
