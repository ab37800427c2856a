#pragma once

#include <condition_variable>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "core/run/progress.h"
#include "core/run/run_merger.h"
#include "core/run/runner.h"

namespace flatspeckle {

/// Scheduler of the batches of many runs. Threads take batches from it and deliver the results,
/// which it accepts in any order.
class BatchPool {
 public:
  /// workers: number of threads that will request batches.
  BatchPool(const RunList& runs, const PoolOptions& options, int workers);

  struct Batch {
    std::size_t run = 0;
    std::uint64_t number = 0;
    std::shared_ptr<const BatchJob> job;
  };
  /// Returns the next batch to be computed by the calling thread of this process, which may first
  /// have to open a run. Waits while no batch is available. Returns nullopt when the pool has
  /// ended.
  std::optional<Batch> take();

  /// Answer to a thread of another rank that requests a batch: a batch, `later` if none is
  /// available now and the thread must request one again, or `none` if the pool has ended.
  enum class Offer { batch, later, none };
  Offer offer(int rank, Batch& batch);

  /// Accepts the sums of a finished batch, and merges all finished batches whose predecessors are
  /// merged. cpu_s: processor time that the thread has used since its last delivery.
  void deliver(const Batch& batch, std::vector<Complex> sums, double cpu_s);

  /// Ends the pool as interrupted. To be called after a thread has abandoned its batch because of a
  /// signal.
  void interrupt();

  /// Ends the pool because a thread has thrown the exception `error`, which finish() rethrows.
  void fail(std::exception_ptr error);

  /// Prints the progress if the last progress line is old enough (Progress::due()).
  void show_progress();

  /// Ends the pool and returns its outcome. To be called after the last delivery.
  PoolEnd finish();

 private:
  struct Sums {
    std::vector<Complex> values;
    double cpu_s;
  };
  /// State of a run from its first to its last batch. `merger` and the RunState may be used only by
  /// the thread that has set `merging`; all other members only by a thread that has locked the
  /// mutex.
  struct Run {
    std::shared_ptr<const BatchJob> job;
    std::unique_ptr<RunMerger> merger;
    std::uint64_t next = 0, merged = 0, certain = 0, limit = 0;
    std::map<std::uint64_t, Sums> waiting;
    bool merging = false;
    double cpu_s = 0, cpu_s_left = 0;
    /// Ranks that have received batches of the run, and therefore have made its job.
    std::set<int> ranks;
  };
  using Runs = std::map<std::size_t, std::shared_ptr<Run>>;

  void check_for_end();
  bool may_take(const Run& run) const;
  enum class Use { own, nobodys, others };
  static Use use_of(const Run& run, int rank);
  Runs::iterator with_certain_batch(int rank, Use worst);
  Runs::iterator with_any_batch();
  Batch hand_out(Runs::iterator found, int rank);
  bool should_open() const;
  bool is_over() const;
  void open_next(std::unique_lock<std::mutex>& lock);
  void merge(std::size_t number, Run& run, std::unique_lock<std::mutex>& lock);
  void save_now_and_then(std::size_t number, Run& run) const;
  void end(std::size_t number, const Run& run, std::unique_lock<std::mutex>& lock);
  Progress::Figures figures() const;
  double seconds_left() const;

  const RunList& list_;
  const PoolOptions& options_;
  std::uint64_t lookahead_;
  std::size_t other_ranks_;
  Stopwatch clock_;
  Progress progress_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Runs runs_;
  std::size_t next_run_ = 0, opening_ = 0, ended_ = 0;
  std::size_t idle_ = 0;  ///< number of runs that needed no work, such as finished runs
  double cpu_s_ = 0, ended_cpu_s_ = 0, first_samples_ = 0, new_samples_ = 0;
  double last_error_ = std::numeric_limits<double>::infinity();
  std::optional<StopReason> stopped_;
  std::exception_ptr error_;
};

/// Server on rank 0 for a pool whose batches are computed by all ranks (MPI processes). Only rank 0
/// opens runs, merges batches and writes results; the other ranks only compute batches that rank 0
/// sends them.
class RankServer {
 public:
  /// Sends batches of the pool to the threads of the other ranks, until the pool has ended and all
  /// these threads have been notified. Call it in a separate thread, not in one that computes
  /// batches.
  void serve(BatchPool& pool) { serve(&pool); }
  /// Notifies all threads of the other ranks that there is no pool to work for, or no further one.
  void dismiss() { serve(nullptr); }

 private:
  void serve(BatchPool* pool);
  void take_in(BatchPool* pool, int rank, const std::vector<std::byte>& message);

  /// Number of threads of the other ranks that have not been notified that the pool has ended.
  int threads_ = 0;
  /// Number of ranks that have not yet sent their number of threads; -1 before serve() counts them.
  int silent_ranks_ = -1;
};

/// Computes batches that rank 0 sends, until the pool has ended. To be called by every rank except
/// rank 0.
void work_for_rank_0(const RunList& runs, int threads);

}  // namespace flatspeckle
