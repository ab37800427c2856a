#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "apps/command_line.h"
#include "apps/run_options.h"
#include "core/result/provenance.h"
#include "core/result/result_file.h"
#include "core/run/runner.h"

namespace flatspeckle::apps {

/// One of the runs of a session. A run without a name has its trace in the root of the result.
struct PlannedRun {
  std::string name, label;
  BatchJob job;
  StopRule stop;
};

/// The runs of one call of the program and the result file they end in. While they run, the file
/// holds what could be resumed; at the end, the result. Each state of it replaces the one before as
/// a whole; what was there before the runs stays beside it (NAME.aside-1) until the result is
/// there.
class Session {
 public:
  /// inputs: what the scene takes from other files, as text; a resumed run must have the same.
  /// Throws InputError where --out is missing or not writable, or where --resume finds a file of
  /// another run.
  Session(const CommandLine& command_line, const RunSettings& settings, std::string plan,
          std::vector<PlannedRun> runs, const std::string& inputs = "");

  const RunState& state(const std::string& run) const { return states_.at(run); }

  /// Runs all to their end, or until an interruption, or goes on with them. Writes the result
  /// (after an interruption: what can be resumed), says so on standard output, and returns the exit
  /// status. contents: everything but provenance, traces and states.
  int run(const std::function<void(ResultFile&)>& contents);

 private:
  void resume(const std::string& path);
  void run_one(const PlannedRun& run);
  int finish(const std::function<void(ResultFile&)>& contents);
  void write_common(ResultFile& file, bool converged) const;
  void save_resumable();
  void set_older_aside();
  void write_states(ResultFile& file) const;

  RunSettings settings_;
  Provenance provenance_;
  std::string identity_;
  std::vector<PlannedRun> runs_;
  std::map<std::string, RunState> states_;
  bool has_older_ = false;   ///< the file there is none of these runs
  std::string older_aside_;  ///< where it is now
  bool already_complete_ = false, interrupted_ = false, converged_ = true;
};

}  // namespace flatspeckle::apps
