#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "core/run/interrupt.h"
#include "core/run/runner.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::test_batch_pool {

namespace {

constexpr double samples_per_batch = 100;

void sleep_seconds(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// Returns a job that averages 1 + uniform numbers. Every eleventh batch takes five times as long.
BatchJob job_of(std::uint64_t seed, double seconds_per_batch = 0) {
  BatchJob job;
  job.size = 1 + seed % 3;
  job.samples_per_batch = samples_per_batch;
  job.run = [=](std::uint64_t number, std::span<Complex> sums) {
    RandomStream random(seed, 1, number);
    for (int i = 0; i < static_cast<int>(samples_per_batch); ++i)
      for (Complex& sum : sums) sum += Complex(1 + random.uniform(), random.uniform());
    if (seconds_per_batch > 0) sleep_seconds(seconds_per_batch * (number % 11 == 3 ? 5 : 1));
  };
  job.relative_error = [](const GroupedSums& sums) {
    return relative_error(jackknife(sums, sample_mean));
  };
  return job;
}

StopRule after_batches(std::uint64_t batches) {
  StopRule stop;
  stop.samples = batches * static_cast<std::uint64_t>(samples_per_batch);
  return stop;
}
StopRule at_error(double error) {
  StopRule stop;
  stop.target_error = error;
  return stop;
}

/// Error reached after about 300 to 1000 batches; it decreases as 1 / sqrt(batches).
constexpr double some_error = 1.2e-3;
constexpr double never = 1e-9;

struct Task {
  BatchJob job;
  StopRule stop;
  RunState state = {};
  std::optional<StopReason> reason = {};
  int endings = 0;
};

/// Returns tasks of various costs and stop rules: few batches, many, a target reached early or
/// late.
std::vector<Task> mixed_tasks() {
  std::vector<Task> tasks;
  for (std::uint64_t i = 0; i < 24; ++i) {
    StopRule stop = after_batches(1 + i * i);
    if (i % 3 == 1) stop = at_error(some_error * (1 + 0.05 * static_cast<double>(i)));
    if (i % 6 == 2) stop.target_error = some_error;
    if (i % 6 == 5) stop.target_error = never;
    tasks.push_back({job_of(i, i % 4 == 0 ? 2e-5 * static_cast<double>(i) : 0), stop});
  }
  return tasks;
}

/// Returns a list of runs that record their end in the tasks.
RunList list_of(std::vector<Task>& tasks) {
  return {tasks.size(),
          [&](std::size_t run) -> OpenRun {
            return {tasks[run].job, tasks[run].stop, &tasks[run].state};
          },
          [&](std::size_t run, StopReason reason) {
            tasks[run].reason = reason;
            ++tasks[run].endings;
          },
          {}};
}

PoolOptions with_threads(int threads) {
  PoolOptions options;
  options.threads = threads;
  return options;
}

void check_same(const RunState& a, const RunState& b) {
  CHECK(a.sums.batches() == b.sums.batches());
  CHECK(a.sums.state().sums == b.sums.state().sums);
  CHECK(a.sums.state().samples == b.sums.state().samples);
  CHECK(a.trace.samples == b.trace.samples);
  CHECK(a.trace.relative_error == b.trace.relative_error);
}

void check_same(const std::vector<Task>& a, const std::vector<Task>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CAPTURE(i);
    check_same(a[i].state, b[i].state);
    CHECK(a[i].reason == b[i].reason);
  }
}

std::vector<Task> one_by_one(std::vector<Task> tasks) {
  for (Task& task : tasks) task.reason = run_batches(task.job, {task.stop, 1, "", {}}, task.state);
  return tasks;
}

}  // namespace

TEST_CASE("batch pool: results agree with single runs for any number of threads") {
  const auto alone = one_by_one(mixed_tasks());
  for (int threads : {1, 2, 7}) {
    CAPTURE(threads);
    auto tasks = mixed_tasks();
    const PoolEnd end = run_pool(list_of(tasks), with_threads(threads));
    CHECK(end.reason == StopReason::samples);
    check_same(tasks, alone);
    for (const Task& task : tasks) CHECK(task.endings == 1);
  }
}

TEST_CASE("batch pool: runs begin in the order of their numbers") {
  auto tasks = mixed_tasks();
  RunList list = list_of(tasks);
  std::mutex mutex;
  std::vector<std::size_t> begun;
  list.open = [&, open = list.open](std::size_t run) {
    const std::lock_guard lock(mutex);
    begun.push_back(run);
    return open(run);
  };
  run_pool(list, with_threads(1));
  CHECK(begun.size() == tasks.size());
  CHECK(std::is_sorted(begun.begin(), begun.end()));
}

TEST_CASE("batch pool: an empty list ends at once") {
  std::vector<Task> none;
  CHECK(run_pool(list_of(none), with_threads(3)).reason == StopReason::samples);
}

TEST_CASE("batch pool: a finished run ends again without another batch") {
  auto tasks = one_by_one(mixed_tasks());
  const auto before = tasks;
  for (Task& task : tasks) {
    task.reason.reset();
    task.job.run = [](std::uint64_t, std::span<Complex>) { throw std::runtime_error("a batch"); };
  }
  CHECK(run_pool(list_of(tasks), with_threads(3)).reason == StopReason::samples);
  check_same(tasks, before);
  for (const Task& task : tasks) CHECK(task.endings == 1);
}

TEST_CASE("batch pool: runs that need no work are skipped") {
  for (std::size_t every : {1, 2, 5}) {
    auto tasks = mixed_tasks();
    RunList list = list_of(tasks);
    list.open = [every, open = list.open](std::size_t run) {
      return run % every == 0 ? std::nullopt : open(run);
    };
    CHECK(run_pool(list, with_threads(3)).reason == StopReason::samples);
    for (std::size_t run = 0; run < tasks.size(); ++run)
      CHECK(tasks[run].endings == (run % every == 0 ? 0 : 1));
  }
}

TEST_CASE("batch pool: the end of a run may release its state") {
  auto tasks = mixed_tasks();
  std::vector<std::unique_ptr<RunState>> states(tasks.size());
  RunList list = list_of(tasks);
  list.open = [&](std::size_t run) -> OpenRun {
    states[run] = std::make_unique<RunState>();
    return {tasks[run].job, tasks[run].stop, states[run].get()};
  };
  list.ended = [&](std::size_t run, StopReason) {
    tasks[run].state = std::move(*states[run]);
    states[run].reset();
    ++tasks[run].endings;
  };
  run_pool(list, with_threads(5));
  const auto alone = one_by_one(mixed_tasks());
  for (std::size_t run = 0; run < tasks.size(); ++run) {
    CHECK(tasks[run].endings == 1);
    check_same(tasks[run].state, alone[run].state);
  }
}

TEST_CASE("batch pool: errors are passed to the caller") {
  auto tasks = mixed_tasks();
  RunList list = list_of(tasks);
  SUBCASE("in a batch") {
    tasks[9].job.run = [](std::uint64_t number, std::span<Complex>) {
      if (number == 20) throw std::runtime_error("it");
    };
  }
  SUBCASE("in the error of a run") {
    tasks[9].job.relative_error = [](const GroupedSums&) -> double {
      throw std::runtime_error("it");
    };
  }
  SUBCASE("when a run begins") {
    list.open = [open = list.open](std::size_t run) {
      return run == 9 ? throw std::runtime_error("it") : open(run);
    };
  }
  SUBCASE("when a run ends") {
    list.ended = [](std::size_t run, StopReason) {
      if (run == 9) throw std::runtime_error("it");
    };
  }
  SUBCASE("when a run ends that had ended before") {
    run_batches(tasks[9].job, {tasks[9].stop, 1, "", {}}, tasks[9].state);
    list.ended = [](std::size_t run, StopReason) {
      if (run == 9) throw std::runtime_error("it");
    };
  }
  for (int threads : {1, 4}) {
    auto again = list;
    CHECK_THROWS_WITH(run_pool(again, with_threads(threads)), "it");
  }
}

TEST_CASE("batch pool: the time limit applies to all runs together") {
  std::vector<Task> tasks;
  for (std::uint64_t i = 0; i < 40; ++i) tasks.push_back({job_of(i, 2e-3), after_batches(300)});
  PoolOptions options = with_threads(2);
  options.seconds = 0.3;
  const PoolEnd end = run_pool(list_of(tasks), options);
  CHECK(end.reason == StopReason::seconds);
  CHECK(end.wall_s >= 0.3);
  CHECK(end.wall_s < 3);  // all would take a quarter of a minute on two threads
  const auto begun = std::count_if(tasks.begin(), tasks.end(),
                                   [](const Task& task) { return task.state.sums.batches() > 0; });
  CHECK(begun > 0);
  CHECK(begun < 40);

  SUBCASE("continued runs agree with uninterrupted ones") {
    for (Task& task : tasks) task.job = job_of(static_cast<std::uint64_t>(&task - tasks.data()));
    CHECK(run_pool(list_of(tasks), with_threads(3)).reason == StopReason::samples);
    std::vector<Task> whole;
    for (std::uint64_t i = 0; i < 40; ++i) whole.push_back({job_of(i), after_batches(300)});
    check_same(tasks, one_by_one(whole));
  }
}

TEST_CASE("batch pool: a run that has begun gets two batches at any time limit") {
  std::vector<Task> tasks;
  for (std::uint64_t i = 0; i < 6; ++i) tasks.push_back({job_of(i, 2e-3), at_error(never)});
  PoolOptions options = with_threads(3);
  options.seconds = 1e-6;
  CHECK(run_pool(list_of(tasks), options).reason == StopReason::seconds);
  CHECK(tasks.front().state.sums.batches() >= 2);
  for (const Task& task : tasks) CHECK(task.state.sums.batches() != 1);
}

TEST_CASE("batch pool: a time limit at the end of the last run is no early end") {
  std::vector<Task> tasks{{job_of(0, 1e-2), after_batches(2)}};
  PoolOptions options = with_threads(1);
  options.seconds = 5e-3;  // over before the second batch, which is always run
  CHECK(run_pool(list_of(tasks), options).reason == StopReason::samples);
}

TEST_CASE("batch pool: runs continued from checkpoints agree with uninterrupted ones") {
  std::vector<Task> tasks;
  for (std::uint64_t i = 0; i < 6; ++i)
    tasks.push_back({job_of(i, 1e-3), i % 2 == 0 ? at_error(some_error) : after_batches(500)});
  const auto fresh = tasks;
  std::mutex mutex;
  std::vector<std::pair<std::size_t, RunState>> saved;
  RunList list = list_of(tasks);
  list.checkpoint = [&](std::size_t run) {
    const std::lock_guard lock(mutex);
    CHECK(tasks[run].endings == 0);
    saved.emplace_back(run, tasks[run].state);
  };
  PoolOptions options = with_threads(3);
  options.seconds_between_saves = 0.02;
  run_pool(list, options);
  CHECK(saved.size() > 6);
  CHECK(saved.size() < 6 * 200);
  for (const auto& [run, state] : saved) {
    CHECK(state.sums.batches() > 0);
    CHECK(state.wall_s > 0);
    RunState later = state;
    const auto& [job, stop, none, reason, endings] = fresh[run];
    run_batches(job_of(run), {stop, 1, "", {}}, later);
    check_same(later, tasks[run].state);
  }
}

TEST_CASE("batch pool: a run whose end is interrupted ends again later") {
  std::vector<Task> tasks{{job_of(0), after_batches(2)}, {job_of(1), after_batches(2)}};
  const RunList whole = list_of(tasks);
  RunList list = whole;
  list.ended = [&](std::size_t run, StopReason reason) {
    if (run == 1) throw Interrupted{};
    whole.ended(run, reason);
  };
  CHECK(run_pool(list, with_threads(1)).reason == StopReason::interrupted);
  CHECK(tasks[1].state.sums.batches() == 2);
  CHECK(run_pool(whole, with_threads(1)).reason == StopReason::samples);
  CHECK(tasks[1].endings == 1);
}

TEST_CASE("batch pool: an error during a checkpoint is passed to the caller") {
  std::vector<Task> tasks{{job_of(0, 1e-3), after_batches(1000)}};
  RunList list = list_of(tasks);
  list.checkpoint = [](std::size_t) { throw std::runtime_error("disk full"); };
  PoolOptions options = with_threads(2);
  options.seconds_between_saves = 0.02;
  CHECK_THROWS_WITH(run_pool(list, options), "disk full");
}

/// Sleeps leave the processor to other programs, so that the time depends on the order of the work
/// even on a busy machine.
TEST_CASE("batch pool: no thread is idle while there is work") {
  constexpr int threads = 4;
  constexpr double nap = 5e-3;
  std::vector<Task> tasks;
  double work = 0;
  const auto add = [&](double seconds_per_batch, std::uint64_t batches) {
    BatchJob job = job_of(0);
    job.run = [=](std::uint64_t, std::span<Complex>) { sleep_seconds(seconds_per_batch); };
    tasks.push_back({job, after_batches(batches)});
    work += seconds_per_batch * static_cast<double>(batches);
  };
  RunList list = list_of(tasks);
  SUBCASE("one long run, then many short ones") {
    add(nap, 160);
    for (int i = 0; i < 80; ++i) add(nap, 2);
  }
  SUBCASE("many short runs, then a long one") {
    for (int i = 0; i < 80; ++i) add(nap, 2);
    add(nap, 160);
  }
  SUBCASE("runs of fewer batches than threads, of very different cost") {
    for (int i = 0; i < 40; ++i) add(i % 2 == 0 ? 8 * nap : nap, 2);
  }
  SUBCASE("runs that take long to begin") {
    for (int i = 0; i < 40; ++i) add(nap, 2);
    list.open = [open = list.open](std::size_t run) {
      sleep_seconds(8 * nap);
      return open(run);
    };
    work += 40 * 8 * nap;
  }
  SUBCASE("runs that take long to end") {
    for (int i = 0; i < 40; ++i) add(nap, 2);
    list.ended = [ended = list.ended](std::size_t run, StopReason reason) {
      sleep_seconds(8 * nap);
      ended(run, reason);
    };
    work += 40 * 8 * nap;
  }
  list.count = tasks.size();
  const PoolEnd end = run_pool(list, with_threads(threads));
  for (const Task& task : tasks) CHECK(task.endings == 1);
  CHECK(end.wall_s < 1.5 * work / threads + 20 * nap);
}

// Must be last: the interrupt flag remains set for the rest of this program.
TEST_CASE("zz batch pool: a signal ends all runs after the current batches, without gaps") {
  catch_interrupts();
  std::vector<Task> tasks;
  for (std::uint64_t i = 0; i < 10; ++i) tasks.push_back({job_of(i, 1e-4), at_error(some_error)});
  std::atomic<int> batches{0};
  tasks[4].job.run = [&, run = tasks[4].job.run](std::uint64_t number, std::span<Complex> sums) {
    run(number, sums);
    if (++batches == 100) std::raise(SIGINT);
  };
  const PoolEnd end = run_pool(list_of(tasks), with_threads(4));
  CHECK(end.reason == StopReason::interrupted);
  for (std::uint64_t i = 0; i < tasks.size(); ++i) {
    CAPTURE(i);
    const RunState& state = tasks[i].state;
    GroupedSums direct(tasks[i].job.size);
    for (std::uint64_t batch = 0; batch < state.sums.batches(); ++batch) {
      std::vector<Complex> sums(direct.size());
      job_of(i).run(batch, sums);
      direct.add(samples_per_batch, sums);
    }
    if (state.sums.batches() > 0) CHECK(direct.state().sums == state.sums.state().sums);
  }
  CHECK(tasks[4].state.sums.batches() >= 90);
  CHECK(tasks[4].state.sums.batches() < 256);
  CHECK(tasks[4].endings == 0);
  CHECK(tasks[9].state.sums.batches() == 0);
}

}  // namespace flatspeckle::test_batch_pool
