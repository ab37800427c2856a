#include "core/run/run_merger.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatspeckle {

namespace {

/// Returns the next checkpoint after this number of batches. Checkpoints, at which the error is
/// compared with the target, are at 8, 10, 12, ... batches; each is a seventh, at least two, above
/// the previous one. They do not depend on time, so that the number of batches of a run is
/// reproducible.
std::uint64_t checkpoint_after(std::uint64_t batches) {
  std::uint64_t next = 8;
  while (next <= batches) next += std::max<std::uint64_t>(2, next / 7);
  return next;
}

bool is_checkpoint(std::uint64_t batches) {
  return batches > 0 && checkpoint_after(batches - 1) == batches;
}

std::uint64_t batch_limit(const StopRule& stop, double samples_per_batch) {
  if (!stop.samples) return std::numeric_limits<std::uint64_t>::max();
  const double batches = std::ceil(static_cast<double>(*stop.samples) / samples_per_batch);
  return std::max(static_cast<std::uint64_t>(batches), fewest_batches);
}

}  // namespace

bool requires_more(const StopRule& stop, const BatchJob& job, const Trace& trace) {
  if (trace.samples.empty()) return true;
  const double batches = std::round(trace.samples.back() / job.samples_per_batch);
  const bool enough_samples =
      stop.samples && batches >= static_cast<double>(batch_limit(stop, job.samples_per_batch));
  const bool exact_enough = stop.target_error &&
                            batches >= static_cast<double>(job.trusted_batches) &&
                            trace.relative_error.back() <= *stop.target_error;
  return !enough_samples && !exact_enough &&
         !(stop.seconds && trace.wall_s.back() >= *stop.seconds);
}

RunMerger::RunMerger(const BatchJob& job, const StopRule& stop, RunState& state)
    : job_(job),
      stop_(stop),
      state_(state),
      clock_(state.wall_s),
      saved_(state.wall_s),
      limit_(batch_limit(stop, job.samples_per_batch)),
      next_checkpoint_(checkpoint_after(state.sums.batches())),
      samples_(state.sums.total_samples()) {
  decide();
  if (!ended_) drop_odd_row();
}

/// Removes the last row of the trace if settle() has added it between checkpoints when the run
/// stopped. A resumed run then has the same trace as a run that never stopped.
void RunMerger::drop_odd_row() {
  Trace& trace = state_.trace;
  if (trace.samples.empty()) return;
  const double batches = std::round(trace.samples.back() / job_.samples_per_batch);
  if (is_checkpoint(static_cast<std::uint64_t>(batches))) return;
  for (const TraceColumn& column : trace_columns) (trace.*column.values).pop_back();
}

void RunMerger::note_saved() {
  saved_ = state_.wall_s = clock_.seconds();
}

void RunMerger::add(std::span<const Complex> sums, double cpu_s) {
  state_.sums.add(job_.samples_per_batch, sums);
  state_.cpu_s += cpu_s;
  samples_ += job_.samples_per_batch;
  if (state_.sums.batches() == next_checkpoint_) {
    record_error();
    next_checkpoint_ = checkpoint_after(next_checkpoint_);
    if (cannot_converge()) ended_ = StopReason::samples;
  }
  decide();
}

/// Whether the run would never end, because a target error is its only stop criterion, and no error
/// can be estimated from many batches, all of them equal.
bool RunMerger::cannot_converge() const {
  constexpr std::uint64_t many = 16 * trusted_batches;
  return state_.sums.batches() >= many && std::isinf(error()) && !stop_.seconds && !stop_.samples;
}

void RunMerger::decide() {
  const std::uint64_t batches = state_.sums.batches();
  if (batches >= limit_) ended_ = StopReason::samples;
  if (stop_.target_error && batches >= job_.trusted_batches && is_checkpoint(batches) &&
      error() <= *stop_.target_error)
    ended_ = StopReason::target_error;
  if (ended_) settle();
}

std::uint64_t RunMerger::certain() const {
  if (!stop_.target_error) return limit_;
  return std::min(limit_, std::max(next_checkpoint_, checkpoint_after(job_.trusted_batches - 1)));
}

double RunMerger::error() const {
  return state_.trace.relative_error.empty() ? std::numeric_limits<double>::infinity()
                                             : state_.trace.relative_error.back();
}

double RunMerger::cpu_s_left() const {
  const double batches = static_cast<double>(state_.sums.batches());
  double left = std::numeric_limits<double>::infinity();
  if (stop_.samples) left = static_cast<double>(limit_) - batches;
  if (stop_.target_error) {
    const double ratio = error() / *stop_.target_error;
    const double enough =
        std::max(batches * ratio * ratio, static_cast<double>(job_.trusted_batches));
    left = std::min(left, enough - batches);
  }
  return std::max(0.0, left) * state_.cpu_s / batches;
}

void RunMerger::settle() {
  state_.wall_s = clock_.seconds();
  if (state_.sums.batches() == 0) return;
  if (state_.trace.samples.empty() || state_.trace.samples.back() != samples_) record_error();
}

/// Returns the relative error; infinite if it cannot be estimated because all batches are equal.
double RunMerger::relative_error() const {
  constexpr double none = 1e-10;  // random sampling cannot attain an error as small as this
  const double error = job_.relative_error(state_.sums);
  const bool is_blind = error < none && found_nothing(job_, state_.sums);
  return is_blind ? std::numeric_limits<double>::infinity() : error;
}

void RunMerger::record_error() {
  state_.wall_s = clock_.seconds();
  state_.trace.wall_s.push_back(state_.wall_s);
  state_.trace.cpu_s.push_back(state_.cpu_s);
  state_.trace.samples.push_back(samples_);
  state_.trace.relative_error.push_back(relative_error());
}

}  // namespace flatspeckle
