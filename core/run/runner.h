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

/// Least number of batches before a run may stop because its target error is reached. With fewer
/// batches the estimated error is unreliable, because rare paths of high weight may be missing.
inline constexpr std::uint64_t trusted_batches = 256;

/// Random sampling divided into numbered batches. The sums of a batch depend only on scene, seed
/// and number of the batch.
struct BatchJob {
  std::size_t size = 0;  ///< number of complex sums that a batch computes
  double samples_per_batch = 1;
  /// Computes the batch of this number and writes its sums to `sums`, which are 0 before. Must be
  /// thread-safe. Long batches should call stop_if_interrupted().
  std::function<void(std::uint64_t number, std::span<Complex> sums)> run;
  /// Returns the relative error of the result of the batches so far, which is compared with the
  /// target error and recorded in the trace. By default it is infinite (unknown).
  std::function<double(const GroupedSums&)> relative_error = [](const GroupedSums&) {
    return std::numeric_limits<double>::infinity();
  };
  /// Whether all batches use one deterministic solution, computed by the first batch. Batches are
  /// then computed one after the other, and their number has no meaning.
  bool one_by_one = false;
  /// Whether the job contains no random sampling, so that equal batches and standard errors of 0
  /// are correct.
  bool deterministic = false;
  /// Least number of batches before a run may stop because its target error is reached; can be
  /// smaller for jobs without rare paths of high weight.
  std::uint64_t trusted_batches = flatspeckle::trusted_batches;
};

/// Whether the job samples at random but all its batches are equal up to rounding. Then no sample
/// has contributed to the sums, and standard errors of 0 are meaningless.
bool found_nothing(const BatchJob& job, const GroupedSums& sums);

/// Criteria that stop a run, as soon as one of them is fulfilled; at least one must be set. The
/// number of samples is rounded up to whole batches, at least two.
struct StopRule {
  std::optional<std::uint64_t> samples;
  std::optional<double> seconds;
  std::optional<double> target_error;
};

/// Error of a run as a function of run time, one row per checkpoint. If the run was resumed, the
/// times include those before the interruption. CPU seconds are summed over all threads.
struct Trace {
  std::vector<double> wall_s, cpu_s, samples, relative_error;
};
/// A column of a Trace: its name in result files, and the member that contains it.
struct TraceColumn {
  const char* name;
  std::vector<double> Trace::*values;
};
inline constexpr TraceColumn trace_columns[] = {{"wall_s", &Trace::wall_s},
                                                {"cpu_s", &Trace::cpu_s},
                                                {"samples", &Trace::samples},
                                                {"relative_error", &Trace::relative_error}};

enum class StopReason { samples, seconds, target_error, interrupted };

/// State from which a run can be resumed: the sums of its batches, its times, and the trace of its
/// error.
struct RunState {
  GroupedSums sums;
  Trace trace;
  double wall_s = 0, cpu_s = 0;
};

struct RunOptions {
  StopRule stop;
  int threads = 0;    ///< 0: as many as there are cores
  std::string label;  ///< name of the run in the progress line; if empty, no progress is shown
  /// Function that is called about once a minute to save the state of the run.
  std::function<void(const RunState&)> checkpoint;
};

/// Computes the batches of a run in parallel threads and adds them in the order of their numbers,
/// so that the result depends only on the number of batches. Continues the run from the batches in
/// `state`. SIGINT and SIGTERM end the run after the current batches.
StopReason run_batches(const BatchJob& job, const RunOptions& options, RunState& state);

/// Computes a run like run_batches(), but throws Interrupted if a signal ends the run early; for
/// work that needs all batches.
void run_to_end(const BatchJob& job, const RunOptions& options, RunState& state);

/// One run of a RunList, as returned by RunList::open().
struct OpenRun {
  BatchJob job;
  StopRule stop;  ///< `seconds` is ignored
  /// State from which the run continues and which it updates; must exist until the run has ended.
  RunState* state = nullptr;
};

/// Many runs that are computed together (as a pool), so that no thread is idle while one of the
/// runs has work. Runs are opened in the order of their numbers, and each is released when it ends.
struct RunList {
  std::size_t count = 0;
  /// Opens the run of this number; returns nullopt if it needs no work. This and the following
  /// functions may be called by several threads at once for different runs; an exception ends the
  /// pool.
  std::function<std::optional<OpenRun>(std::size_t run)> open;
  std::function<void(std::size_t run, StopReason)> ended;
  /// Called from time to time to save the state of the run, which does not change during the call.
  std::function<void(std::size_t run)> checkpoint;
  /// Returns the job of a run, for other processes; needed only if PoolOptions::server is set.
  std::function<BatchJob(std::size_t run)> job = {};
};

class RankServer;

struct PoolOptions {
  /// Time limit for all runs together. Runs that have begun before the limit are given at least two
  /// batches.
  std::optional<double> seconds;
  int threads = 0;  ///< 0: as many as there are cores
  /// Name of the work, and name of its runs, in the progress line. If the label is empty, no
  /// progress is shown.
  std::string label, run_name = "runs";
  /// Server that sends batches to other MPI processes; nullptr if there is only one process.
  RankServer* server = nullptr;
  double seconds_between_saves = 60;  ///< seconds between calls of RunList::checkpoint() for a run
  /// Name of the samples in the progress line; if empty, the number of samples is not shown.
  std::string unit = "samples";
};

/// Outcome of a pool. reason: StopReason::samples if all runs have ended, otherwise the reason why
/// the pool was stopped before.
struct PoolEnd {
  StopReason reason = StopReason::samples;
  double wall_s = 0, cpu_s = 0;
};

/// Computes all runs of the list. The final state of a run depends only on its own job and stop
/// rule. If the pool is stopped early, the other runs can be resumed from their states.
PoolEnd run_pool(const RunList& runs, const PoolOptions& options);

/// Returns the number of cores that this process may use.
int default_threads();

}  // namespace flatspeckle
