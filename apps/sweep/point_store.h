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

/// Journals of points in these folders, by any share of any sweep. Throws InputError for a folder
/// in which points have files of their own, as sweeps of curves once had them.
std::vector<std::filesystem::path> journals_in(const std::string& folder);

/// What folders hold of a sweep: finished runs of all its shares, and of this share those at work.
/// For any thread.
class PointStore {
 public:
  /// What is there, to read. Journals of other sweeps are left out.
  PointStore(const Sweep& sweep, const std::vector<std::string>& folders);
  /// The same, and to go on with as this share. Throws InputError where its own journal is of
  /// another sweep, or of an earlier one that is not to be resumed.
  PointStore(const Sweep& sweep, const std::string& folder);

  bool has(std::size_t run) const;
  /// Of the sweep's runs.
  std::size_t finished() const { return finished_; }
  /// Each that is finished, in their order.
  void for_each(const std::function<void(std::size_t run, const FinishedPoint&)>& use) const;
  /// What was left out, a line each.
  const std::string& warnings() const { return warnings_; }

  void add(std::size_t run, const FinishedPoint& finished);
  /// Of a run at work; `size` sums. Empty where there is none.
  RunState unfinished(std::size_t run, std::size_t size) const;
  void save_unfinished(std::size_t run, const RunState& state) const;
  void sync() { journals_.front()->sync(); }
  /// Throws IoError where the journals are gone from the folders.
  void require_in_place() const;

  /// All of this sweep, and each folder if nothing else is in it.
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
  std::vector<std::unique_ptr<PointJournal>> journals_;  ///< this share's first
  std::vector<std::filesystem::path> paths_;
  std::vector<std::uint64_t> places_;  ///< of the runs, with the number of the journal; 0: none
  std::size_t finished_ = 0, strangers_ = 0;
  mutable std::mutex mutex_;
  Stopwatch clock_;
  std::atomic<double> synced_ = 0;
};

}  // namespace flatspeckle::apps
