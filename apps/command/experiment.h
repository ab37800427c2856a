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

/// Plan of an experiment: its batches, and the function that writes the result.
struct PlannedExperiment {
  std::string plan;  ///< description of the method, for the result file
  BatchJob batches;
  /// Writes the result of all batches, except provenance, traces and states. If `prints` is true,
  /// also prints tables and notes, and writes counts of work, which depend on threads and
  /// interruptions. `prints` is true for a single run, and false within a sweep or search.
  std::function<void(ResultFile&, const GroupedSums&, bool prints)> write;
};

/// One run that makes one result from the values of its keys. A subcommand such as `covariance`
/// makes one run; a sweep makes many runs with different values.
class Experiment {
 public:
  virtual ~Experiment() = default;

  /// Sets the default seed; to be called before add_keys(). Deterministic experiments ignore it,
  /// and reject a seed given by the user.
  void set_default_seed(std::uint64_t seed) { run_.seed = static_cast<std::int64_t>(seed); }
  /// Declares that only the keys will be printed (--print-config), so that read() may omit slow
  /// work. To be called before read().
  void only_print() { only_prints_ = true; }
  /// Adds all keys that read() uses, including those of the run (out, threads ...). The keys set
  /// members of this object.
  virtual void add_keys(Keys& keys) = 0;
  /// Makes the scene from the keys and checks all input. Throws InputError.
  virtual void read(const Keys& keys) = 0;
  /// Prints notes about the scene on standard error, before the run.
  virtual void note() const {}
  /// Plans the run; to be called after read(). May take some time for a pilot run.
  virtual PlannedExperiment plan() const = 0;
  /// Makes the run as the only one of the program, writes its result, and returns the exit status.
  virtual int run_alone(Session& session, const std::string& label) const;

  const RunSettings& run() const { return run_; }
  const StopRule& stop() const { return stop_; }
  /// Returns the contents of the other files that the scene uses, as text; it is part of the
  /// identity of the run.
  const std::string& inputs() const { return inputs_; }

 protected:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(run_.seed); }

  RunSettings run_;
  StopRule stop_;
  std::string inputs_;
  bool only_prints_ = false;
};

/// An experiment whose result is made in one piece, without batches.
class OneShot : public Experiment {
 public:
  OneShot() { stop_.samples = 2; }  // two batches, as explained at plan()
  /// Plans two batches: the first calls make(), and the second does nothing. The result is stored
  /// only in this process; if the first batch was run by another process or before an interruption,
  /// PlannedExperiment::write calls make() again.
  PlannedExperiment plan() const override;
  int run_alone(Session& session, const std::string& label) const override;

 protected:
  /// Computes the result and writes it to `file`. prints: whether the result is also printed on
  /// standard output. In a sweep or search, throws Interrupted after a signal; a single run is
  /// ended by the signal at once.
  virtual Made make(ResultFile& file, bool prints) const = 0;
  /// Returns where the result file of a single run is built: in memory or on disk.
  virtual ResultFile::Storage storage() const { return ResultFile::Storage::memory; }
  int threads() const {
    return run_.threads > 0 ? static_cast<int>(run_.threads) : default_threads();
  }
};

}  // namespace flatspeckle::apps
