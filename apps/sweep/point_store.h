#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "apps/sweep/point_journal.h"
#include "apps/sweep/sweep.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::apps {

/// Returns the paths of all journals in a folder, of any sweep and shard. Throws InputError if the
/// folder contains one file per point, the format of earlier versions.
std::vector<std::filesystem::path> journals_in(const std::string& folder);

/// Stored runs of a sweep: the finished runs of all its shards, and the unfinished runs of the
/// shard that this process computes. Thread-safe.
class PointStore {
 public:
  /// Opens the stored runs in these folders for reading. Journals of other sweeps are ignored.
  PointStore(const Sweep& sweep, const std::vector<std::string>& folders);
  /// Opens the stored runs in the folder, to add runs of the shard that sweep.share() gives. Throws
  /// InputError if the journal of this shard belongs to another sweep, or if it exists and --resume
  /// is not given.
  PointStore(const Sweep& sweep, const std::string& folder);

  bool has(std::size_t run) const;
  /// Returns the number of finished runs of the sweep.
  std::size_t finished() const { return finished_; }
  /// Calls `use` for each finished run, in the order of the runs.
  void for_each(const std::function<void(std::size_t run, const FinishedPoint&)>& use) const;
  /// Returns warnings about stored data that is ignored, one per line.
  const std::string& warnings() const { return warnings_; }

  void add(std::size_t run, const FinishedPoint& finished);
  /// Returns the saved state of an unfinished run; an empty state if none is saved. size: number of
  /// sums of a batch of the run.
  RunState unfinished(std::size_t run, std::size_t size) const;
  void save_unfinished(std::size_t run, const RunState& state) const;
  void sync() { journals_.front()->sync(); }
  /// Throws IoError if one of the journals has been removed from its folder.
  void require_in_place() const;

  /// Removes all files of this sweep from its folders, and each folder that is then empty.
  void remove();

 private:
  void open_others(const std::string& folder, const std::filesystem::path& own);
  PointJournal::Found notes();
  void note(std::size_t run, std::size_t journal, std::uint64_t place);
  std::filesystem::path unfinished_file(const std::string& name) const;
  std::string identity_of(const std::string& name) const { return identity_ + name + '\n'; }
  void remove_unfinished(const std::filesystem::path& folder) const;

  const Sweep& sweep_;
  PointFinder finder_;
  std::string identity_, warnings_;
  std::vector<std::string> folders_;
  std::vector<std::unique_ptr<PointJournal>> journals_;  ///< the first one is that of this shard
  std::vector<std::filesystem::path> paths_;
  /// For each run, its position in a journal in the lower bits, and the index of that journal in
  /// the upper bits; 0 if the run is not finished.
  std::vector<std::uint64_t> places_;
  std::size_t finished_ = 0, foreign_files_ = 0;
  mutable std::mutex mutex_;
  Stopwatch clock_;
  std::atomic<double> synced_ = 0;
};

}  // namespace flatspeckle::apps
