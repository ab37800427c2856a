#pragma once

#include <atomic>
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

  bool has(const std::string& name) const { return find(name) != nullptr; }
  FinishedPoint read(const std::string& name) const { return find(name)->read(name); }
  /// Of the sweep's points, in their order, those that are finished.
  std::vector<std::size_t> finished() const;

  void add(const std::string& name, const FinishedPoint& point);
  /// Of a point at work; `size` sums. Empty where there is none.
  RunState unfinished(const std::string& name, std::size_t size);
  void save_unfinished(const std::string& name, const Provenance& made, const RunState& state);
  void sync() { own_->sync(); }

  /// All of this sweep, and each folder if nothing else is in it.
  void remove();

 private:
  void open_others(const std::string& folder, const std::filesystem::path& own);
  const PointJournal* find(const std::string& name) const;
  std::string identity_of(const std::string& name) const;
  std::set<std::string> ours_of(const std::set<std::string>& names) const;

  const ExperimentSweep& sweep_;
  std::string identity_;
  std::vector<std::string> folders_;
  std::unique_ptr<ShardFolder> folder_;
  std::unique_ptr<PointJournal> own_;
  std::vector<std::unique_ptr<PointJournal>> others_;
  std::vector<std::filesystem::path> paths_;  ///< of all
  Stopwatch clock_;
  std::atomic<double> synced_ = 0;
};

}  // namespace flatspeckle::apps
