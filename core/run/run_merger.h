#pragma once

#include "core/run/runner.h"
#include "core/run/stopwatch.h"

namespace flatspeckle {

/// Merges the batches of one run, which come in number order, notes how its error falls, and
/// decides when there are enough of them. That depends on their numbers alone. One thread at a
/// time.
class RunMerger {
 public:
  /// Goes on from what `state` holds.
  RunMerger(const BatchJob& job, const StopRule& stop, RunState& state);

  /// Batch number state.sums.batches(). cpu_s: what it cost.
  void add(std::span<const Complex> sums, double cpu_s);

  /// Set once there are enough batches.
  const std::optional<StopReason>& ended() const { return ended_; }
  /// No batch from this number on is ever merged.
  std::uint64_t limit() const { return limit_; }
  /// Batches below this number are merged in any case.
  std::uint64_t certain() const;
  /// Relative, at the last checkpoint; infinite before.
  double error() const;
  /// CPU seconds until the end, guessed from what has been merged; infinite where nothing tells.
  double cpu_s_left() const;

  double seconds_since_saved() const { return clock_.seconds() - saved_; }
  /// Brings the time of the state up to date.
  void note_saved();
  /// Brings time and trace of the state up to date.
  void settle();

 private:
  void decide();
  bool is_in_vain() const;
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

/// Whether a run that ended with this trace would not have by this rule.
bool asks_more(const StopRule& stop, const BatchJob& job, const Trace& trace);

/// A run of one batch alone would say nothing about its error.
constexpr std::uint64_t fewest_batches = 2;

}  // namespace flatspeckle
