#include "bench/plan/plan_timing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/measure/median.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

constexpr int most_rounds = 15;
constexpr double quick = 1;  // CPU seconds; less time means a quick run

double quartile_distance(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t quarter = values.size() / 4;
  return values[values.size() - 1 - quarter] - values[quarter];
}

/// Returns the largest |a - b| relative to the largest |b|.
double relative_difference(std::span<const Complex> a, std::span<const Complex> b) {
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(b[i]));
  }
  return difference / largest;
}

/// Runs the batches of a kernel in order, and sums the first `compared` of them.
class Contestant {
 public:
  Contestant(const SampledKernel& kernel, std::uint64_t compared)
      : kernel_(kernel), compared_(compared), sums_(kernel.size), batch_(kernel.size) {}

  double seconds_per_sample(int batches) {
    const double start = thread_cpu_seconds();
    for (int b = 0; b < batches; ++b) one_batch();
    return (thread_cpu_seconds() - start) / (batches * kernel_.samples_per_batch);
  }

  /// Returns the CPU seconds needed for a relative error of 1 %, extrapolated from these batches
  /// alone.
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
  if (rounds > 0)  // the first round only warms up the caches
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

void compare_estimates(PlanRow& row, const Estimate& general, const Estimate& special) {
  for (std::size_t e = 0; e < general.value.size(); ++e)
    if (const double off = std::abs(general.value[e] - special.value[e]); off > 0)
      row.difference =
          std::max(row.difference, off / std::hypot(general.error[e], special.error[e]));
  row.limit = 4;
  row.difference_in = "standard errors";
}

PlanCase named(const PlanName& name,
               const std::function<void(PlanRow& row, double cpu_seconds)>& run) {
  return [=](double cpu_seconds) {
    PlanRow row{name.module_name, name.left_out, name.scene, name.per};
    run(row, cpu_seconds);
    return row;
  };
}

PlanCase case_of_values(const PlanName& name, double limit, const MakeAlternatives& make,
                        int count) {
  return named(name, [=](PlanRow& row, double cpu_seconds) {
    const auto [general, special] = make(cpu_seconds < quick);
    std::vector<Complex> a, b;
    compare_times(row, timed([&, &compute = general] { a = compute(); }),
                  timed([&, &compute = special] { b = compute(); }), cpu_seconds);
    row.general_s /= count;
    row.special_s /= count;
    row.difference = relative_difference(a, b);
    row.limit = limit;
    row.difference_in = "relative";
  });
}

PlanCase case_of_samples(const PlanName& name, Draws numbers, Measure measure,
                         const std::function<TwoKernels()>& make) {
  constexpr double rounding = 1e-11;
  constexpr int batches_for_an_error = 48;
  const bool to_error = measure == Measure::error;
  const std::string per = to_error ? "1 % error" : name.per;
  return named({name.module_name, name.left_out, name.scene, per},
               [=](PlanRow& row, double cpu_seconds) {
                 const auto [general, special] = make();
                 const std::uint64_t compared = cpu_seconds < quick ? 32 : 64;
                 Contestant one(general, compared), other(special, compared);
                 const auto slice_of = [&](Contestant& contestant) -> Slice {
                   return [&](int batches) {
                     return to_error ? contestant.seconds_to_error(batches)
                                     : contestant.seconds_per_sample(batches);
                   };
                 };
                 compare_times(row, slice_of(one), slice_of(other), cpu_seconds,
                               to_error ? batches_for_an_error : 1);
                 const Estimate a = one.estimate(), b = other.estimate();
                 if (numbers == Draws::other) return compare_estimates(row, a, b);
                 row.difference = relative_difference(a.value, b.value);
                 row.limit = rounding;
                 row.difference_in = "relative";
               });
}

std::vector<PlanCase> plan_cases() {
  std::vector<PlanCase> cases;
  for (const auto& cases_of :
       {mc_plan_cases, transport_plan_cases, field_plan_cases, fit_plan_cases, search_plan_cases,
        imaging_plan_cases, wave_plan_cases, ray_plan_cases, render_plan_cases, design_plan_cases})
    for (PlanCase& plan_case : cases_of()) cases.push_back(std::move(plan_case));
  return cases;
}

bool passes(const PlanRow& row) {
  return row.difference <= row.limit;
}

}  // namespace flatspeckle::bench
