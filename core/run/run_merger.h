#pragma once

#include "core/run/runner.h"
#include "core/run/stopwatch.h"

namespace flatspeckle {

/// Adds the batches of one run to its sums in the order of their numbers, records the error of the
/// run at checkpoints (certain numbers of batches), and decides when the run has enough batches.
/// This decision depends only on the batches that are already added. Not thread-safe.
class RunMerger {
 public:
  /// Continues the run from the batches that `state` already contains.
  RunMerger(const BatchJob& job, const StopRule& stop, RunState& state);

  /// Adds the sums of the next batch, whose number is state.sums.batches(). cpu_s: processor time
  /// of the batch.
  void add(std::span<const Complex> sums, double cpu_s);

  /// Returns why the run has ended; nullopt if it needs more batches.
  const std::optional<StopReason>& ended() const { return ended_; }
  /// Returns the largest number of batches that the run may have.
  std::uint64_t limit() const { return limit_; }
  /// Returns the number of batches that the run needs at least, whatever their errors turn out to
  /// be.
  std::uint64_t certain() const;
  /// Returns the relative error of the run at the last checkpoint; infinite before the first
  /// checkpoint.
  double error() const;
  /// Returns the processor time, in seconds, that the run probably still needs, extrapolated from
  /// its batches so far; infinite if unknown.
  double cpu_s_left() const;

  double seconds_since_saved() const { return clock_.seconds() - saved_; }
  /// Sets the run time in the state to the present, and records that the state was saved now.
  void note_saved();
  /// Sets the run time in the state to the present, and adds the present error to its trace.
  void settle();

 private:
  void decide();
  bool cannot_converge() const;
  double relative_error() const;
  void record_error();
  void drop_odd_row();

  const BatchJob& job_;
  StopRule stop_;
  RunState& state_;
  Stopwatch clock_;
  double saved_;
  std::uint64_t limit_, next_checkpoint_;
  double samples_;
  std::optional<StopReason> ended_;
};

/// Whether a run that has ended with this trace needs more batches to fulfil this stop rule.
bool requires_more(const StopRule& stop, const BatchJob& job, const Trace& trace);

/// Least number of batches of a run; from a single batch no error can be estimated.
constexpr std::uint64_t fewest_batches = 2;

}  // namespace flatspeckle
