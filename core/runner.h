#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/statistics.h"

namespace flatspeckle {

/// Random work cut into numbered batches: each a pure function (scene, seed, number) -> sums.
struct BatchJob {
  std::size_t size = 0;  ///< complex sums per batch
  double samples_per_batch = 1;
  /// Adds batch `number` to `sums` (zeroed). Called from several threads at once.
  std::function<void(std::uint64_t number, std::span<Complex> sums)> run;
  /// Relative error of what has been merged so far; steers the target and fills the trace.
  std::function<double(const GroupedSums&)> relative_error;
};

/// When to stop; any that is set may. At least one must be. Samples are rounded up to whole
/// batches, of which there are always two.
struct StopRule {
  std::optional<std::uint64_t> samples;
  std::optional<double> seconds;
  std::optional<double> target_error;
};

/// Error against run time, one row per checkpoint. Times are this run's plus those of the runs that
/// it resumes; CPU seconds are those of all threads.
struct Trace {
  std::vector<double> wall_s, cpu_s, samples, relative_error;
};

enum class StopReason { samples, seconds, target_error, interrupted };

/// Merged batches and how the error fell; everything that is needed to go on later.
struct RunState {
  GroupedSums sums;
  Trace trace;
  double wall_s = 0, cpu_s = 0;
};

struct RunOptions {
  StopRule stop;
  int threads = 0;    ///< 0: as many as there are cores
  std::string label;  ///< shown with the progress; empty: silent
  /// Called about once a minute with what could be resumed.
  std::function<void(const RunState&)> checkpoint;
};

/// Runs batches over threads and merges them in number order, so that the result depends on the
/// number of batches alone. Goes on from `state` where that holds batches already. SIGINT and
/// SIGTERM end it after the batches in hand.
StopReason run_batches(const BatchJob& job, const RunOptions& options, RunState& state);

int default_threads();

}  // namespace flatspeckle
