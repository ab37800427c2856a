#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/statistics.h"

namespace flatspeckle {

/// A target error is believed from here on: fewer batches miss the tail of rare strong paths.
inline constexpr std::uint64_t trusted_batches = 256;

/// Random work cut into numbered batches: each a pure function (scene, seed, number) -> sums.
struct BatchJob {
  std::size_t size = 0;  ///< complex sums per batch
  double samples_per_batch = 1;
  /// Adds batch `number` to `sums` (zeroed). Called from several threads at once. A long one looks
  /// whether it is to stop (interrupt.h).
  std::function<void(std::uint64_t number, std::span<Complex> sums)> run;
  /// Relative error of what has been merged so far; steers the target and fills the trace. Unknown
  /// unless it is asked for, as of runs that stop at a number of samples.
  std::function<double(const GroupedSums&)> relative_error = [](const GroupedSums&) {
    return std::numeric_limits<double>::infinity();
  };
  /// Batches share their work, a solution without chance: a thread that took the second would wait
  /// for the first, and their number says nothing.
  bool one_by_one = false;
  /// Whether nothing is sampled: batches are equal by construction, and errors of 0 are right.
  bool deterministic = false;
  /// Less where there is no such tail.
  std::uint64_t trusted_batches = flatspeckle::trusted_batches;
};

/// Whether the batches of a job that samples are all the same to rounding: what it samples has
/// reached none of its sums, and standard errors of 0 say nothing.
bool found_nothing(const BatchJob& job, const GroupedSums& sums);

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
/// All of them, by name.
struct TraceColumn {
  const char* name;
  std::vector<double> Trace::*values;
};
inline constexpr TraceColumn trace_columns[] = {{"wall_s", &Trace::wall_s},
                                                {"cpu_s", &Trace::cpu_s},
                                                {"samples", &Trace::samples},
                                                {"relative_error", &Trace::relative_error}};

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

/// Runs batches as run_batches() does, for work that needs all of them: throws Interrupted where a
/// signal ends it before.
void run_to_end(const BatchJob& job, const RunOptions& options, RunState& state);

/// One of many runs, once its turn has come.
struct OpenRun {
  BatchJob job;
  StopRule stop;              ///< `seconds` is not looked at
  RunState* state = nullptr;  ///< goes on from what it holds; must live until the run has ended
};

/// Runs that are worked on as one pool, so that no thread is idle while there is anything to do:
/// begun in the order of their numbers, forgotten one by one as they end.
struct RunList {
  std::size_t count = 0;
  /// Any thread calls these, for different runs at once. What they throw ends the pool.
  /// Nothing where the run needs no work.
  std::function<std::optional<OpenRun>(std::size_t run)> open;
  std::function<void(std::size_t run, StopReason)> ended;
  /// Called once in a while, while the state stands still, to save what could be resumed.
  std::function<void(std::size_t run)> checkpoint;
  /// The job alone, for other processes; only needed with a server.
  std::function<BatchJob(std::size_t run)> job = {};
};

class RankServer;

struct PoolOptions {
  std::optional<double> seconds;         ///< for all together; every begun run gets two batches
  int threads = 0;                       ///< 0: as many as there are cores
  std::string label, run_name = "runs";  ///< for the progress; silent without a label
  RankServer* server = nullptr;          ///< to other ranks, where they work too
  double seconds_between_saves = 60;     ///< of each run, by its checkpoint()
  std::string unit = "samples";          ///< for the progress; empty: they are not worth counting
};

/// reason: samples where all runs have ended, else why they have not.
struct PoolEnd {
  StopReason reason = StopReason::samples;
  double wall_s = 0, cpu_s = 0;
};

/// What a run's state holds at its end depends on its own job and stop rule alone. Runs that have
/// not ended when the pool does can go on from their states later.
PoolEnd run_pool(const RunList& runs, const PoolOptions& options);

/// Cores that this process may use.
int default_threads();

}  // namespace flatspeckle
