#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/command_line.h"
#include "apps/run_options.h"
#include "core/provenance.h"
#include "core/result_file.h"
#include "core/result_reader.h"
#include "core/runner.h"

namespace flatspeckle::apps {

/// The runs of one call of the program and the result file they end in. While they run, the file
/// holds what could be resumed; at the end, the result. Each state of it replaces the one before as
/// a whole.
class Session {
 public:
  /// Throws InputError where --out is missing or not writable, or where --resume finds a file of
  /// another run.
  Session(const CommandLine& command_line, const RunSettings& settings, std::string plan);

  /// --resume found a file that holds the finished result: there is nothing to do.
  bool already_complete() const { return already_complete_; }

  /// Runs a job to its end or goes on with it. Runs have different names; after an interruption the
  /// remaining ones do nothing. The state stays where it is until the session ends.
  const RunState& run(const std::string& name, const std::string& label, const BatchJob& job,
                      const StopRule& stop);

  bool interrupted() const { return interrupted_; }

  /// Writes the result (after an interruption: what can be resumed), says so on standard output,
  /// and returns the exit status. contents: everything but provenance, traces and states.
  int finish(const std::function<void(ResultFile&)>& contents);

 private:
  void resume(const std::string& path);
  void write_common(ResultFile& file, bool converged) const;
  void save_resumable() const;
  void write_states(ResultFile& file) const;

  RunSettings settings_;
  Provenance provenance_;
  std::string identity_;
  std::map<std::string, RunState> states_;
  std::unique_ptr<ResultReader> resumed_;
  std::vector<std::string> run_names_;
  bool already_complete_ = false, interrupted_ = false, converged_ = true;
};

}  // namespace flatspeckle::apps
