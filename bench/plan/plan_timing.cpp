#include "bench/plan/plan_timing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/measure/median.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

constexpr int most_rounds = 15;
constexpr double quick = 1;  // CPU seconds: fewer are only a look

double quartile_distance(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t quarter = values.size() / 4;
  return values[values.size() - 1 - quarter] - values[quarter];
}

/// A kernel at work: its batches in order, and the sums of the first of them.
class Contestant {
 public:
  Contestant(const SampledKernel& kernel, std::uint64_t compared)
      : kernel_(kernel), compared_(compared), sums_(kernel.size), batch_(kernel.size) {}

  double seconds_per_sample(int batches) {
    const double start = thread_cpu_seconds();
    for (int b = 0; b < batches; ++b) one_batch();
    return (thread_cpu_seconds() - start) / (batches * kernel_.samples_per_batch);
  }

  /// CPU seconds to a relative error of 1 %, from these batches alone.
  double seconds_to_error(int batches) {
    constexpr double target = 0.01;
    GroupedSums slice(kernel_.size);
    const double start = thread_cpu_seconds();
    for (int b = 0; b < batches; ++b) {
      one_batch();
      slice.add(kernel_.samples_per_batch, batch_);
    }
    const double spent = thread_cpu_seconds() - start;
    const double error = relative_error(jackknife(slice, kernel_.estimator));
    return spent * error * error / (target * target);
  }

  Estimate estimate() {
    while (done_ < compared_) one_batch();
    return jackknife(sums_, kernel_.estimator);
  }

 private:
  void one_batch() {
    std::fill(batch_.begin(), batch_.end(), 0);
    kernel_.run(done_, batch_);
    if (done_ < compared_) sums_.add(kernel_.samples_per_batch, batch_);
    ++done_;
  }

  const SampledKernel& kernel_;
  std::uint64_t compared_, done_ = 0;
  GroupedSums sums_;
  std::vector<Complex> batch_;
};

}  // namespace

Slice timed(std::function<void()> work) {
  return [work = std::move(work)](int calls) {
    const double start = thread_cpu_seconds();
    for (int i = 0; i < calls; ++i) work();
    return (thread_cpu_seconds() - start) / calls;
  };
}

void compare_times(PlanRow& row, const Slice& general, const Slice& special, double cpu_seconds,
                   int fewest_calls) {
  const double start = thread_cpu_seconds();
  std::vector<double> general_s = {general(fewest_calls)}, special_s = {special(fewest_calls)};
  std::vector<double> ratio = {general_s.back() / special_s.back()};
  const double both = (thread_cpu_seconds() - start) / fewest_calls;
  const double affordable = cpu_seconds / both;
  const int fewest_rounds = cpu_seconds < quick ? 0 : 3;
  const int rounds =
      std::clamp(static_cast<int>(affordable / fewest_calls), fewest_rounds, most_rounds);
  const int calls = std::max(fewest_calls, static_cast<int>(affordable / std::max(rounds, 1)));
  if (rounds > 0)  // that was to warm up
    for (auto* times : {&general_s, &special_s, &ratio}) times->clear();
  for (int round = 0; round < rounds; ++round) {
    const bool turned = round % 2 == 1;
    if (turned) special_s.push_back(special(calls));
    general_s.push_back(general(calls));
    if (!turned) special_s.push_back(special(calls));
    ratio.push_back(general_s.back() / special_s.back());
  }
  row.general_s = median(general_s);
  row.special_s = median(special_s);
  row.ratio = median(ratio);
  row.ratio_spread = quartile_distance(ratio) / 2;
}

double relative_difference(std::span<const Complex> a, std::span<const Complex> b) {
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(b[i]));
  }
  return difference / largest;
}

double most_standard_errors(const Estimate& a, const Estimate& b) {
  double most = 0;
  for (std::size_t e = 0; e < a.value.size(); ++e)
    if (const double off = std::abs(a.value[e] - b.value[e]); off > 0)
      most = std::max(most, off / std::hypot(a.error[e], b.error[e]));
  return most;
}

void compare_values(PlanRow& row, const Values& general, const Values& special, double limit,
                    double cpu_seconds) {
  std::vector<Complex> a, b;
  compare_times(row, timed([&] { a = general(); }), timed([&] { b = special(); }), cpu_seconds);
  row.difference = relative_difference(a, b);
  row.limit = limit;
  row.difference_in = "relative";
}

void compare_sampled(PlanRow& row, const SampledKernel& general, const SampledKernel& special,
                     Numbers numbers, Measure measure, double cpu_seconds) {
  constexpr double rounding = 1e-11, standard_errors = 4;
  constexpr int batches_for_an_error = 48;
  const std::uint64_t compared = cpu_seconds < quick ? 32 : 64;
  Contestant one(general, compared), other(special, compared);
  if (measure == Measure::sample)
    compare_times(
        row, [&](int batches) { return one.seconds_per_sample(batches); },
        [&](int batches) { return other.seconds_per_sample(batches); }, cpu_seconds);
  else
    compare_times(
        row, [&](int batches) { return one.seconds_to_error(batches); },
        [&](int batches) { return other.seconds_to_error(batches); }, cpu_seconds,
        batches_for_an_error);
  const Estimate a = one.estimate(), b = other.estimate();
  const bool same = numbers == Numbers::same;
  row.difference = same ? relative_difference(a.value, b.value) : most_standard_errors(a, b);
  row.limit = same ? rounding : standard_errors;
  row.difference_in = same ? "relative" : "standard errors";
}

}  // namespace flatspeckle::bench
