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
#include "core/session/output_file.h"
#include "core/session/run_settings.h"

namespace flatspeckle {

/// Returns the first line of the text `there` that the text `here` does not contain, to show how
/// two runs differ. Both are identities of runs: texts that list scene and seed as lines "key =
/// value", and all other inputs.
std::string first_difference(const std::string& there, const std::string& here);

/// Returns a line with name and checksum for each input file that a key names, if the key was read.
std::string inputs_text(const Keys& keys);

/// Exit statuses of the program (README).
enum ExitStatus : int {
  done = 0,
  bad_input = 2,
  error_not_reached = 3,
  io_failed = 4,
  row_failed = 5,  ///< a row of a benchmark failed; the result is written
  interrupted_resumable = 75,
  interrupted_for_good = 130  ///< interrupted; nothing is written that could be resumed
};

class ResultReader;

/// One of the runs of a session. `name` is the group of the result that receives the trace of the
/// run; if empty, the root receives it.
struct PlannedRun {
  std::string name, label;
  BatchJob job;
  StopRule stop;
};

/// Summary of a result that was computed in one piece, without batches: description of the method,
/// number of samples and exit status.
struct Made {
  std::string plan;
  double samples = 1;
  int status = ExitStatus::done;
};

/// One call of the program and its result file. It is constructed before any work, so that errors
/// of the output path are found early. At the end it writes the provenance of the result and prints
/// the path of the file.
class Session {
 public:
  /// Kind of the output file. `other`: not a result file; it may replace an existing file of any
  /// kind. `shared`: a result to which several processes contribute and which is locked by the
  /// caller, not by this class.
  enum class Out { result, other, shared };
  /// Reads the keys of the run and marks seed and threads as read. command_line: the command as
  /// typed. only_prints: true if no result is written. Throws InputError if the key `out` is not
  /// given or its file cannot be written.
  Session(std::string command_line, const Keys& keys, const RunSettings& settings,
          bool only_prints = false, Out kind = Out::result);

  std::uint64_t seed() const { return seed_; }
  /// Returns the number of threads of this process. It is reduced if other MPI processes run on the
  /// same cores, which is known after initialize_ranks().
  int threads() const;
  const std::string& out() const { return settings_.out; }

  /// Calls `make`, which fills `file`, and writes the file. Writes nothing if `make` throws
  /// Interrupted. Returns the exit status.
  int once(ResultFile file, const std::function<Made(ResultFile&)>& make) const;

  /// Throws InputError if --resume is given and the output file exists but does not contain this
  /// run. run() does the same; it can be called before a plan is made that takes time. inputs: see
  /// run().
  void require_same_run(const std::string& inputs) const;

  /// Computes all runs until they end or are interrupted, and returns the exit status. With
  /// --resume, continues the runs in the existing file, and extends finished runs if this call
  /// requires more samples. The output file contains a state that can be resumed while the runs are
  /// computed, and the result at the end. It is always replaced as a whole; a file of another run
  /// is backed up (NAME.aside-1) until the result is written. inputs: text of all other files that
  /// the scene uses, which must be the same when the runs are resumed. contents: function that
  /// writes the result except provenance, traces and states.
  int run(std::string plan, std::vector<PlannedRun> runs, const std::string& inputs,
          const std::function<void(ResultFile&)>& contents);

  /// Returns the sums of a run that has ended.
  const GroupedSums& sums(const std::string& run) const { return states_.at(run).sums; }

  /// Whether --resume is given and the output file already contains the complete result of the run
  /// with this identity; if so, prints a line. If the file contains the result of another run,
  /// throws InputError unless has_begun is true. has_begun: whether unfinished work of this run
  /// exists.
  bool is_complete(const std::string& identity, bool has_begun) const;

  /// Returns the provenance of a result of this call, except `plan` and the costs of the
  /// computation.
  Provenance provenance() const;
  /// Completes a result file: writes the provenance, commits the file with a checksum, and prints
  /// its path.
  static void commit(ResultFile& file, const Provenance& provenance);

 private:
  std::string identity_of(const std::string& inputs) const;
  void resume();
  void report_unfinished() const;
  bool extends(const ResultReader& file) const;
  static void note_rounding(const PlannedRun& run);
  void run_one(const PlannedRun& run);
  int finish(const std::function<void(ResultFile&)>& contents);
  void write_common(ResultFile& file, bool converged) const;
  void save_resumable();
  void back_up_older();
  void back_up_foreign_files();
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
  bool has_older_ = false;    ///< true if the existing output file belongs to another run
  std::string older_backup_;  ///< path of the backup of the file of another run
  /// Stamp of the output file when it was last checked or written.
  std::optional<FileStamp> known_;
  bool already_complete_ = false, interrupted_ = false, converged_ = true;
  bool blind_ = false;  ///< true if all batches of one of the runs are equal (see found_nothing())
};

}  // namespace flatspeckle
