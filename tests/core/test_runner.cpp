#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "core/run/interrupt.h"
#include "core/run/runner.h"

namespace flatspeckle::test_runner {

namespace {

/// Returns a job that averages 100 numbers 1 + uniform per batch; uneven run times reorder batches.
BatchJob uneven_job() {
  BatchJob job;
  job.size = 2;
  job.samples_per_batch = 100;
  job.run = [](std::uint64_t number, std::span<Complex> sums) {
    RandomStream random(11, 1, number);
    for (int i = 0; i < 100; ++i) {
      sums[0] += 1 + random.uniform();
      sums[1] += Complex(0, random.uniform());
    }
    if (number % 7 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));
  };
  job.relative_error = [](const GroupedSums& sums) {
    return relative_error(jackknife(sums, sample_mean));
  };
  return job;
}

RunState run(const BatchJob& job, StopRule stop, int threads, RunState state = {}) {
  RunOptions options{stop, threads, "", {}};
  run_batches(job, options, state);
  return state;
}

bool same_sums(const RunState& a, const RunState& b) {
  return a.sums.state().sums == b.sums.state().sums && a.sums.batches() == b.sums.batches();
}

}  // namespace

TEST_CASE("runner: the result depends on the number of batches, not on threads") {
  const auto job = uneven_job();
  StopRule stop;
  stop.samples = 50'000;
  const auto one = run(job, stop, 1);
  CHECK(one.sums.batches() == 500);
  for (int threads : {2, 4, 13}) CHECK(same_sums(one, run(job, stop, threads)));
}

TEST_CASE("runner: samples are rounded up to whole batches") {
  StopRule stop;
  stop.samples = 101;
  CHECK(run(uneven_job(), stop, 2).sums.total_samples() == 200);
}

TEST_CASE("runner: a target error stops at the same batch for any number of threads") {
  StopRule stop;
  stop.target_error = 6e-4;
  const auto job = uneven_job();
  const auto one = run(job, stop, 1), four = run(job, stop, 4);
  CHECK(one.trace.relative_error.back() <= 6e-4);
  CHECK(one.trace.relative_error[one.trace.relative_error.size() - 2] > 6e-4);
  CHECK(same_sums(one, four));
}

TEST_CASE("runner: a resumed run equals an uninterrupted one") {
  const auto job = uneven_job();
  StopRule half, whole;
  half.samples = 12'300;
  whole.samples = 30'000;
  CHECK(same_sums(run(job, whole, 3), run(job, whole, 2, run(job, half, 3))));
}

TEST_CASE("runner: the relative error decreases with slope -1/2 in samples") {
  StopRule stop;
  stop.samples = 400'000;
  const auto trace = run(uneven_job(), stop, 2).trace;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < trace.samples.size(); ++i) {
    if (trace.samples[i] < 5000) continue;
    const double lx = std::log(trace.samples[i]), ly = std::log(trace.relative_error[i]);
    n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
  }
  CHECK(n > 10);
  CHECK((n * xy - x * y) / (n * xx - x * x) == doctest::Approx(-0.5).epsilon(0.1));
  for (std::size_t i = 1; i < trace.wall_s.size(); ++i)
    CHECK(trace.wall_s[i] >= trace.wall_s[i - 1]);
}

TEST_CASE("runner: equal batches do not satisfy a target error unless deterministic") {
  // Direct light in closed form, and scattered light that no path samples.
  BatchJob job;
  job.size = 2;
  job.samples_per_batch = 100;
  job.run = [](std::uint64_t number, std::span<Complex> sums) {
    for (std::uint64_t i = 0; i < 100; ++i) sums[0] += 0.1353 * (1 + 1e-16 * double(number % 3));
  };
  job.relative_error = [](const GroupedSums& sums) {
    return relative_error(jackknife(sums, sample_mean));
  };
  StopRule stop;
  stop.target_error = 0.01;
  const auto reason = [&](const BatchJob& of) {
    RunState state;
    return run_batches(of, {stop, 2, "", {}}, state);
  };
  CHECK(reason(job) == StopReason::samples);
  BatchJob dark = job;
  dark.run = [](std::uint64_t, std::span<Complex>) {};
  CHECK(reason(dark) == StopReason::samples);
  job.deterministic = true;
  CHECK(reason(job) == StopReason::target_error);
  // Little light added to a closed form that is not in the sums.
  job.deterministic = false;
  job.run = [](std::uint64_t number, std::span<Complex> sums) {
    sums[0] += 1e-14 * RandomStream(5, 1, number).uniform();
  };
  job.relative_error = [](const GroupedSums& sums) {
    return relative_error(jackknife(sums, [](double samples, std::span<const Complex> all) {
      return std::vector<Complex>{1.0 + all[0] / samples};
    }));
  };
  CHECK(reason(job) == StopReason::target_error);
}

TEST_CASE("runner: a time limit ends a run without other limits") {
  StopRule stop;
  stop.seconds = 0.05;
  const auto state = run(uneven_job(), stop, 2);
  CHECK(state.sums.batches() > 0);
  CHECK(state.wall_s < 10);
}

TEST_CASE("runner: an error in a batch is passed to the caller") {
  auto job = uneven_job();
  job.run = [](std::uint64_t number, std::span<Complex>) {
    if (number == 20) throw std::runtime_error("batch 20");
  };
  StopRule stop;
  stop.samples = 100'000;
  CHECK_THROWS_WITH(run(job, stop, 4), "batch 20");
}

TEST_CASE("runner: an interrupted batch ends the run with the batches before it") {
  auto job = uneven_job();
  job.run = [body = job.run](std::uint64_t number, std::span<Complex> sums) {
    if (number == 20) throw Interrupted{};
    body(number, sums);
  };
  StopRule stop;
  stop.samples = 100'000;
  RunState state;
  CHECK(run_batches(job, {stop, 2, "", {}}, state) == StopReason::interrupted);
  CHECK(state.sums.batches() == 20);
  CHECK_THROWS_AS(run_to_end(job, {stop, 2, "", {}}, state), Interrupted);
}

TEST_CASE("runner: one_by_one batches never run at the same time") {
  auto job = uneven_job();
  job.one_by_one = true;
  std::atomic<int> running{0}, most{0};
  job.run = [&, body = job.run](std::uint64_t number, std::span<Complex> sums) {
    most = std::max(most.load(), ++running);
    body(number, sums);
    --running;
  };
  StopRule stop;
  stop.samples = 20'000;
  CHECK(same_sums(run(job, stop, 4), run(uneven_job(), stop, 1)));
  CHECK(most == 1);
}

// Must be last: the interrupt flag remains set for the rest of this program.
TEST_CASE("zz runner: a signal ends the run after the current batches, without a gap") {
  catch_interrupts();
  auto job = uneven_job();
  std::atomic<bool> raised{false};
  const auto body = job.run;
  job.run = [&](std::uint64_t number, std::span<Complex> sums) {
    body(number, sums);
    if (number == 50 && !raised.exchange(true)) std::raise(SIGTERM);
  };
  StopRule stop;
  stop.samples = 10'000'000;
  RunState state;
  CHECK(run_batches(job, {stop, 4, "", {}}, state) == StopReason::interrupted);
  CHECK(state.sums.batches() > 50);
  CHECK(state.sums.batches() < 200);
  GroupedSums direct(2);
  for (std::uint64_t b = 0; b < state.sums.batches(); ++b) {
    std::vector<Complex> sums(2);
    body(b, sums);
    direct.add(100, sums);
  }
  CHECK(direct.state().sums == state.sums.state().sums);
}

}  // namespace flatspeckle::test_runner
