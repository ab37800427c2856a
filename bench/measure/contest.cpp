#include "bench/measure/contest.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/measure/median.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

double efficiency_of(const FieldJob& job, const GroupedSums& sums, double cpu_s) {
  const double error = job.batches.relative_error(sums);
  return 1 / (error * error * cpu_s);
}

void run_slice(Contender& contender, double seconds) {
  const BatchJob& batches = contender.job.batches;
  constexpr std::uint64_t fewest_batches = 16;
  GroupedSums slice(batches.size);
  std::vector<Complex> sums(batches.size);
  double spent = 0;
  while (spent < seconds || slice.batches() < fewest_batches) {
    std::fill(sums.begin(), sums.end(), 0);
    const double start = thread_cpu_seconds();
    batches.run(contender.sums.batches(), sums);
    spent += thread_cpu_seconds() - start;
    slice.add(batches.samples_per_batch, sums);
    contender.sums.add(batches.samples_per_batch, sums);
  }
  contender.cpu_s += spent;
  contender.slice_efficiency.push_back(efficiency_of(contender.job, slice, spent));
}

}  // namespace

double Contender::efficiency() const {
  return efficiency_of(job, sums, cpu_s);
}

void compete(std::vector<Contender>& contenders, int rounds, double seconds) {
  for (int round = 0; round < rounds; ++round) {
    for (Contender& contender : contenders) run_slice(contender, seconds);
    std::reverse(contenders.begin(), contenders.end());
  }
  if (rounds % 2 == 1) std::reverse(contenders.begin(), contenders.end());
}

Outcome compare(const Contender& ours, const Contender& theirs) {
  std::vector<double> log_ratio;
  for (std::size_t round = 0; round < ours.slice_efficiency.size(); ++round)
    log_ratio.push_back(std::log(ours.slice_efficiency[round] / theirs.slice_efficiency[round]));
  const double middle = median(log_ratio);
  double spread = 0;
  for (double value : log_ratio) spread += (value - middle) * (value - middle);
  const auto count = static_cast<double>(log_ratio.size());
  // 1.25: the median of normal numbers against their mean
  const double log_error = 1.25 * std::sqrt(spread / count / std::max(1.0, count - 1));

  const Estimate a = ours.estimate(), b = theirs.estimate();
  double most = 0, sum = 0;
  for (std::size_t e = 0; e < a.value.size(); ++e) {
    const double difference = std::abs(a.value[e] - b.value[e]);
    if (difference == 0) continue;
    const double sigma = difference / std::hypot(a.error[e], b.error[e]);
    most = std::max(most, sigma);
    sum += sigma * sigma;
  }
  const double rms = std::sqrt(sum / static_cast<double>(a.value.size()));
  return {std::exp(middle), log_error, ours.efficiency() / theirs.efficiency(), most, rms};
}

}  // namespace flatspeckle::bench
