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

/// The batches of many runs, handed out to threads and taken back in any order.
class BatchPool {
 public:
  /// workers: threads that will ask for batches.
  BatchPool(const RunList& runs, const PoolOptions& options, int workers);

  struct Batch {
    std::size_t run = 0;
    std::uint64_t number = 0;
    std::shared_ptr<const BatchJob> job;
  };
  /// The next batch, for a thread that also opens runs when their turn comes; waits while there is
  /// none. Nothing once all is over.
  std::optional<Batch> take();

  /// The same for a thread of another rank, which must ask again later where none is to be had now.
  enum class Offer { batch, later, none };
  Offer offer(int rank, Batch& batch);

  /// cpu_s: what the thread has spent since its last delivery. Merges what can be merged.
  void deliver(const Batch& batch, std::vector<Complex> sums, double cpu_s);

  /// A thread has given up its batch, for a signal came: the runs end as interrupted.
  void interrupt();

  /// A thread threw: no more batches are handed out, and finish() throws this.
  void fail(std::exception_ptr error);

  /// Shows how the work gets on, where that is due.
  void show_progress();

  /// After the last delivery.
  PoolEnd finish();

 private:
  struct Sums {
    std::vector<Complex> values;
    double cpu_s;
  };
  /// What is known of a run between its first and last batch. The merger and the state belong to
  /// the one thread that has set `merging`, all else to who holds the lock.
  struct Run {
    std::shared_ptr<const BatchJob> job;
    std::unique_ptr<RunMerger> merger;
    std::uint64_t next = 0, merged = 0, certain = 0, limit = 0;
    std::map<std::uint64_t, Sums> waiting;
    bool merging = false;
    double cpu_s = 0, cpu_s_left = 0;
    std::set<int> ranks;  ///< that have had a batch of it, and so its job
  };
  using Runs = std::map<std::size_t, std::shared_ptr<Run>>;

  void look_for_end();
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
  std::size_t idle_ = 0;  ///< that needed no work
  double cpu_s_ = 0, ended_cpu_s_ = 0, first_samples_ = 0, new_samples_ = 0;
  double last_error_ = std::numeric_limits<double>::infinity();
  std::optional<StopReason> stopped_;
  std::exception_ptr error_;
};

/// Rank 0's side of a pool that all ranks work on: it alone opens runs, merges and writes; the
/// others only compute the batches that it hands out.
class RankServer {
 public:
  /// Hands batches of the pool to the threads of the other ranks until it is over and each of them
  /// has been told so. For a thread of its own, beside those that work here.
  void serve(BatchPool& pool) { serve(&pool); }
  /// Tells all that it is over, where no pool comes (any more).
  void dismiss() { serve(nullptr); }

 private:
  void serve(BatchPool* pool);
  void take_in(BatchPool* pool, int rank, const std::vector<std::byte>& message);

  int threads_ = 0;        ///< of other ranks that have not been told
  int silent_ranks_ = -1;  ///< that have not said how many threads they have; -1: not counted
};

/// On every other rank: works on batches that rank 0 hands out, until all is over.
void work_for_rank_0(const RunList& runs, int threads);

}  // namespace flatspeckle
