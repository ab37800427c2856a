#include "core/runner.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <map>
#include <mutex>

#include <omp.h>

#include "core/interrupt.h"
#include "core/progress.h"
#include "core/stopwatch.h"

namespace flatspeckle {

namespace {

/// Batches at which the error is looked at: 8, 10, 12, ... growing by a seventh each time. They
/// depend on nothing but the number of batches, so a run that stops at a target is reproducible.
std::uint64_t checkpoint_after(std::uint64_t batches) {
  std::uint64_t next = 8;
  while (next <= batches) next += std::max<std::uint64_t>(2, next / 7);
  return next;
}

bool is_checkpoint(std::uint64_t batches) {
  return batches > 0 && checkpoint_after(batches - 1) == batches;
}

/// One batch alone says nothing about its error.
constexpr std::uint64_t fewest_batches = 2;

std::uint64_t batch_limit(const StopRule& stop, double samples_per_batch) {
  if (!stop.samples) return std::numeric_limits<std::uint64_t>::max();
  const double batches = std::ceil(static_cast<double>(*stop.samples) / samples_per_batch);
  return std::max(static_cast<std::uint64_t>(batches), fewest_batches);
}

/// Takes batches in any order, merges them in number order, and decides when enough is enough.
class Merger {
 public:
  Merger(const BatchJob& job, const RunOptions& options, RunState& state, int threads)
      : job_(job),
        options_(options),
        state_(state),
        clock_(state.wall_s),
        progress_(options.label, options.stop),
        next_(state.sums.batches()),
        limit_(batch_limit(options.stop, job.samples_per_batch)),
        lookahead_(16 * static_cast<std::uint64_t>(threads)),
        first_samples_(state.sums.total_samples()),
        first_wall_(state.wall_s),
        samples_(first_samples_),
        last_saved_(state.wall_s),
        next_checkpoint_(checkpoint_after(state.sums.batches())) {
    if (next_ >= limit_) reason_ = StopReason::samples;
    if (is_checkpoint(next_) && target_reached()) reason_ = StopReason::target_error;
  }

  /// The next batch to run; nothing when the run is over. Waits while far ahead of a slow batch.
  std::optional<std::uint64_t> take() {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] { return reason_ || next_ < state_.sums.batches() + lookahead_; });
    if (interrupted()) stop(StopReason::interrupted);
    if (options_.stop.seconds && next_ >= fewest_batches &&
        clock_.seconds() >= *options_.stop.seconds)
      stop(StopReason::seconds);
    if (reason_ || next_ >= limit_) return std::nullopt;
    return next_++;
  }

  /// cpu_s: what the thread has spent since its last delivery.
  void deliver(std::uint64_t number, std::vector<Complex> sums, double cpu_s) {
    const std::lock_guard lock(mutex_);
    state_.cpu_s += cpu_s;
    waiting_.emplace(number, std::move(sums));
    while (!waiting_.empty() && waiting_.begin()->first == state_.sums.batches() && !closed_) {
      state_.sums.add(job_.samples_per_batch, waiting_.begin()->second);
      samples_ += job_.samples_per_batch;
      waiting_.erase(waiting_.begin());
      after_merge();
    }
    room_.notify_all();
  }

  /// A batch threw: no more are handed out.
  void fail(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(error);
    stop(StopReason::interrupted);
    closed_ = true;
  }

  StopReason finish() {
    if (error_) std::rethrow_exception(error_);
    note_time();
    if (state_.trace.samples.empty() || state_.trace.samples.back() != samples_) record_error();
    progress_.finish(samples_, state_.wall_s, state_.trace.relative_error.back());
    return reason_.value_or(StopReason::samples);
  }

 private:
  void after_merge() {
    if (state_.sums.batches() == next_checkpoint_) {
      record_error();
      next_checkpoint_ = checkpoint_after(next_checkpoint_);
      if (target_reached()) {
        stop(StopReason::target_error);
        closed_ = true;  // what is in hand would make the result depend on timing
      }
    }
    const double wall = clock_.seconds();
    const double error =
        state_.trace.relative_error.empty() ? INFINITY : state_.trace.relative_error.back();
    progress_.update(samples_, samples_ - first_samples_, wall, wall - first_wall_, error);
    constexpr double seconds_between_saves = 60;
    if (options_.checkpoint && wall - last_saved_ > seconds_between_saves) {
      note_time();
      options_.checkpoint(state_);
      last_saved_ = wall;
    }
  }

  bool target_reached() const {
    constexpr std::uint64_t trusted_batches = 256;  // fewer miss the tail of rare strong paths
    return options_.stop.target_error && state_.sums.batches() >= trusted_batches &&
           !state_.trace.relative_error.empty() &&
           state_.trace.relative_error.back() <= *options_.stop.target_error;
  }

  void record_error() {
    note_time();
    state_.trace.wall_s.push_back(state_.wall_s);
    state_.trace.cpu_s.push_back(state_.cpu_s);
    state_.trace.samples.push_back(samples_);
    state_.trace.relative_error.push_back(job_.relative_error(state_.sums));
  }

  void note_time() { state_.wall_s = clock_.seconds(); }

  void stop(StopReason reason) {
    if (!reason_) reason_ = reason;
    room_.notify_all();
  }

  const BatchJob& job_;
  const RunOptions& options_;
  RunState& state_;
  Stopwatch clock_;
  Progress progress_;
  std::uint64_t next_, limit_, lookahead_;
  double first_samples_, first_wall_, samples_, last_saved_;
  std::uint64_t next_checkpoint_;
  std::mutex mutex_;
  std::condition_variable room_;
  std::map<std::uint64_t, std::vector<Complex>> waiting_;
  std::optional<StopReason> reason_;
  std::exception_ptr error_;
  bool closed_ = false;
};

void work(const BatchJob& job, Merger& merger) {
  try {
    double cpu_before = thread_cpu_seconds();
    while (const auto number = merger.take()) {
      std::vector<Complex> sums(job.size);
      job.run(*number, sums);
      const double cpu_now = thread_cpu_seconds();
      merger.deliver(*number, std::move(sums), cpu_now - cpu_before);
      cpu_before = cpu_now;
    }
  } catch (...) {
    merger.fail(std::current_exception());
  }
}

}  // namespace

int default_threads() {
  return omp_get_num_procs();
}

StopReason run_batches(const BatchJob& job, const RunOptions& options, RunState& state) {
  if (state.sums.size() != job.size) state.sums = GroupedSums(job.size);
  const int threads = options.threads > 0 ? options.threads : default_threads();
  Merger merger(job, options, state, threads);
#pragma omp parallel num_threads(threads)
  work(job, merger);
  return merger.finish();
}

}  // namespace flatspeckle
