#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "core/result/provenance.h"
#include "core/result/result_file.h"
#include "core/run/interrupt.h"
#include "core/run/runner.h"
#include "core/run/stopwatch.h"
#include "core/session/run_settings.h"

namespace flatspeckle {

/// What tells one run from another: its scene and seed as lines "key = value", and what else it was
/// made from. The first line of one identity that the other does not have.
std::string first_difference(const std::string& there, const std::string& here);

/// The files that keys name and that were read, each by name and checksum, a line each.
std::string inputs_text(const Keys& keys);

/// Where a file that is in the way is kept: the first of NAME.aside-1, NAME.aside-2 ... that is
/// free.
std::filesystem::path free_aside(const std::filesystem::path& path);

/// Gives a file, or the file that a link leads to, such a name, by a second one beside its own
/// where the file system can, so that the first is never without a file; returns it. Throws
/// IoError.
std::filesystem::path set_aside(const std::filesystem::path& path);

/// Tells one file at a path from another, or from itself rewritten.
struct FileStamp {
  std::uint64_t device, inode;
  std::int64_t seconds, nanoseconds;  ///< of its last change
  bool operator==(const FileStamp&) const = default;
};
/// Nothing where there is no file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// Exit statuses (README).
enum ExitStatus : int {
  done = 0,
  bad_input = 2,
  error_not_reached = 3,
  io_failed = 4,
  row_failed = 5,  ///< a row of a benchmark; the result is written
  interrupted_resumable = 75,
  interrupted_for_good = 130  ///< nothing written, nothing to resume
};

/// Keeps an output to one process at a time, by a lock on .NAME.lock beside it, or beside the file
/// that a link leads to, that ends with the process however that ends. Where the file system has no
/// locks there is none. Removes the temporary files that killed processes have left there.
class OutputLock {
 public:
  /// Throws InputError, which names the process that has the output.
  explicit OutputLock(const std::filesystem::path& out);
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;
  ~OutputLock();

 private:
  bool take(const std::filesystem::path& out);

  std::filesystem::path path_;
  std::optional<RemovedIfEnded> removed_;
  int descriptor_ = -1;
};

class ResultReader;

/// One of the runs of a session. A run without a name has its trace in the root of the result.
struct PlannedRun {
  std::string name, label;
  BatchJob job;
  StopRule stop;
};

/// What was made at once: in words how, and of how many samples.
struct Made {
  std::string plan;
  double samples = 1;
  int status = ExitStatus::done;
};

/// One call of the program and the result file it ends in. Made before any work, it refuses what
/// can be refused by then; at the end it writes how the result came about, and says where it is.
class Session {
 public:
  /// command_line: as typed. Reads seed and threads. only_prints: no result is wanted.
  /// Throws InputError where `out` is missing or not writable.
  /// Kinds of files: one that is no result may be replaced; a result that several processes make
  /// together they keep to themselves.
  enum class Out { result, other, shared };
  Session(std::string command_line, const Keys& keys, const RunSettings& settings,
          bool only_prints = false, Out kind = Out::result);

  std::uint64_t seed() const { return seed_; }
  /// Of this process: fewer where it shares its machine with other ranks, once it has joined them.
  int threads() const;
  const std::string& out() const { return settings_.out; }

  /// Writes what `make` fills in one go; nothing where it throws Interrupted.
  int once(ResultFile file, const std::function<Made(ResultFile&)>& make) const;

  /// Runs all to their end, or until an interruption, or goes on with those that the file there
  /// holds; runs that have ended there are extended where this call asks for more. While they run,
  /// the file holds what could be resumed; at the end, the result. Each state of it replaces the
  /// one before as a whole; what was there before the runs stays beside it (NAME.aside-1) until the
  /// result is there. inputs: what the scene takes from other files, as text; a resumed run must
  /// have the same. contents: everything but provenance, traces and states. Returns the exit
  /// status.
  int run(std::string plan, std::vector<PlannedRun> runs, const std::string& inputs,
          const std::function<void(ResultFile&)>& contents);

  /// Of a run, once it has ended.
  const GroupedSums& sums(const std::string& run) const { return states_.at(run).sums; }

  /// Whether --resume finds the whole result of this identity there, which is said. Throws
  /// InputError where another run's is, unless this one has begun to replace it.
  bool is_complete(const std::string& identity, bool has_begun) const;

  /// How results of this call came about, but for plan and costs.
  Provenance provenance() const;
  /// Ends a file that is whole but for that, with a seal; says where it is.
  static void commit(ResultFile& file, const Provenance& provenance);

 private:
  void resume();
  void tell_unfinished() const;
  bool extends(const ResultReader& file) const;
  static void note_rounding(const PlannedRun& run);
  void run_one(const PlannedRun& run);
  int finish(const std::function<void(ResultFile&)>& contents);
  void write_common(ResultFile& file, bool converged) const;
  void save_resumable();
  void set_older_aside();
  void set_strangers_aside();
  void write_states(ResultFile& file) const;
  std::size_t state_bytes() const;

  std::string command_line_;
  const Keys& keys_;
  const RunSettings& settings_;
  std::uint64_t seed_;
  std::string started_;
  Stopwatch clock_;
  double cpu_before_ = process_cpu_seconds();
  std::unique_ptr<const OutputLock> lock_;

  std::string plan_, identity_;
  std::vector<PlannedRun> runs_;
  std::map<std::string, RunState> states_;
  bool has_older_ = false;          ///< the file there is none of these runs
  std::string older_aside_;         ///< where it is now
  std::optional<FileStamp> known_;  ///< of the file there, when it was last looked at or written
  bool already_complete_ = false, interrupted_ = false, converged_ = true;
  bool blind_ = false;  ///< a run has found nothing that varies
};

}  // namespace flatspeckle
