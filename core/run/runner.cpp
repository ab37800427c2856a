#include "core/run/runner.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include <omp.h>

#include "core/contract.h"
#include "core/run/batch_pool.h"
#include "core/run/interrupt.h"
#include "core/run/ranks.h"
#include "core/run/stopwatch.h"

namespace flatspeckle {

namespace {

void work(BatchPool& pool) {
  try {
    double cpu_before = thread_cpu_seconds();
    while (const auto batch = pool.take()) {
      std::vector<Complex> sums(batch->job->size);
      batch->job->run(batch->number, sums);
      const double cpu_now = thread_cpu_seconds();
      pool.deliver(*batch, std::move(sums), cpu_now - cpu_before);
      cpu_before = cpu_now;
    }
  } catch (const Interrupted&) {
    pool.interrupt();
  } catch (...) {
    pool.fail(std::current_exception());
  }
}

/// Prints the progress of a pool at regular times from a thread of its own, also during long
/// batches.
class ProgressWatch {
 public:
  explicit ProgressWatch(BatchPool& pool)
      : thread_([this, &pool](const std::stop_token& end) { show(pool, end); }) {}

 private:
  void show(BatchPool& pool, const std::stop_token& end) {
    std::unique_lock lock(mutex_);
    while (!end.stop_requested()) {
      ended_.wait_for(lock, end, std::chrono::milliseconds(200), [] { return false; });
      pool.show_progress();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any ended_;
  // declared last, so that the thread ends before the members that it uses are destroyed
  std::jthread thread_;
};

}  // namespace

int default_threads() {
  return std::max(1, omp_get_num_procs() / ranks().sharers);
}

bool found_nothing(const BatchJob& job, const GroupedSums& sums) {
  return !job.deterministic && !job.one_by_one && !varies(sums);
}

PoolEnd run_pool(const RunList& runs, const PoolOptions& options) {
  const int threads = options.threads > 0 ? options.threads : default_threads();
  BatchPool pool(runs, options, threads * ranks().size);
  std::thread server;
  if (options.server != nullptr) server = std::thread([&] { options.server->serve(pool); });
  {
    const ProgressWatch watch(pool);
#pragma omp parallel num_threads(threads)
    work(pool);
  }
  if (server.joinable()) server.join();
  return pool.finish();
}

StopReason run_batches(const BatchJob& job, const RunOptions& options, RunState& state) {
  const auto& [samples, seconds, target_error] = options.stop;
  FS_EXPECT(job.run && job.size > 0 && job.samples_per_batch > 0);
  FS_EXPECT(samples || seconds || target_error);
  StopReason ended = StopReason::samples;
  RunList one{1,
              [&](std::size_t) {
                return OpenRun{job, options.stop, &state};
              },
              [&](std::size_t, StopReason reason) { ended = reason; },
              {},
              {}};
  if (options.checkpoint) one.checkpoint = [&](std::size_t) { options.checkpoint(state); };
  PoolOptions pool{seconds, options.threads, options.label, ""};
  if (seconds) *pool.seconds -= state.wall_s;
  if (job.one_by_one) pool.unit.clear();
  const double cpu_before = state.cpu_s;
  const PoolEnd end = run_pool(one, pool);
  state.cpu_s = cpu_before + end.cpu_s;
  return end.reason == StopReason::samples ? ended : end.reason;
}

void run_to_end(const BatchJob& job, const RunOptions& options, RunState& state) {
  if (run_batches(job, options, state) == StopReason::interrupted) throw Interrupted{};
}

}  // namespace flatspeckle
