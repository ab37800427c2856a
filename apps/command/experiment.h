#pragma once

#include <functional>
#include <memory>
#include <string>

#include "apps/command/command_line.h"
#include "core/keys/keys.h"
#include "core/result/result_file.h"
#include "core/run/runner.h"
#include "core/session/run_settings.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

/// Work that is planned, and what becomes of its sums.
struct PlannedExperiment {
  std::string plan;  ///< how the numbers are found
  BatchJob batches;
  /// The result of all batches, all that the file has but provenance, traces and states. tells:
  /// also what a run of its own tells, tables on standard output, notes, and counts of the work
  /// that depend on threads and interruptions.
  std::function<void(ResultFile&, const GroupedSums&, bool tells)> write;
};

/// What a subcommand makes of its keys: one result. An object is one run of it, which a subcommand
/// does alone and a sweep many times with other values.
class Experiment {
 public:
  virtual ~Experiment() = default;

  /// In place of the default; before add_keys(). What has no chance in it takes no seed that is
  /// given, but any default.
  void set_default_seed(std::uint64_t seed) { run_.seed = static_cast<std::int64_t>(seed); }
  /// Only the keys are wanted (--print-config): what takes time in read() may be left out. Before
  /// read().
  void only_print() { only_prints_ = true; }
  /// Keys of all it reads, those of the run too; they are bound to this object.
  virtual void add_keys(Keys& keys) = 0;
  /// Makes the scene. All that can be refused is refused here: throws InputError.
  virtual void read(const Keys& keys) = 0;
  /// What to know of the scene before it is run: on standard error.
  virtual void note() const {}
  /// After read(). May take some time, as a pilot does.
  virtual PlannedExperiment plan() const = 0;
  /// One run as a call of the program. Returns the exit status.
  virtual int run_alone(Session& session, const std::string& label) const;

  const RunSettings& run() const { return run_; }
  const StopRule& stop() const { return stop_; }
  /// What the scene takes from other files, as text.
  const std::string& inputs() const { return inputs_; }

 protected:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(run_.seed); }

  RunSettings run_;
  StopRule stop_;
  std::string inputs_;
  bool only_prints_ = false;
};

/// A result that is made in one go.
class OneShot : public Experiment {
 public:
  OneShot() { stop_.samples = 2; }  // batches
  /// Plans two batches, of which the first makes the result and the second is empty. The result is
  /// kept in this process alone: where another one ran the first batch, or an interrupted one, it
  /// is made again when it is written.
  PlannedExperiment plan() const override;
  int run_alone(Session& session, const std::string& label) const override;

 protected:
  /// Makes the result. tells: on standard output, too. Within a sweep or a search it throws
  /// Interrupted once a signal has come; signals end a run alone at once.
  virtual Made make(ResultFile& file, bool tells) const = 0;
  /// Of a file of its own.
  virtual ResultFile::Storage storage() const { return ResultFile::Storage::memory; }
  int threads() const {
    return run_.threads > 0 ? static_cast<int>(run_.threads) : default_threads();
  }
};

}  // namespace flatspeckle::apps
