#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "flatland/request/field_moments.h"

namespace flatspeckle::bench {

/// An estimator and what it achieved: the runs of all rounds together, and of each.
struct Contender {
  std::string name;
  FieldJob job;
  GroupedSums sums{job.batches.size};
  double cpu_s = 0;
  std::vector<double> slice_efficiency{};  ///< 1 / (relative error^2 CPU seconds) of every round

  Estimate estimate() const { return jackknife(sums, job.covariance); }
  /// Of all rounds together; what rare strong paths add to the error is seen here first.
  double efficiency() const;
};

/// All contenders in turn on this thread, `seconds` each, in every round; the order turns round
/// from one to the next.
void compete(std::vector<Contender>& contenders, int rounds, double seconds);

/// Efficiency of one relative to another: the median over rounds and the standard error of its
/// logarithm; both together; and the differences in combined standard errors: the largest, and the
/// RMS over the entries, which is about 1.
struct Outcome {
  double median, log_error, together, most_sigma, rms_sigma;
};
Outcome compare(const Contender& ours, const Contender& theirs);

}  // namespace flatspeckle::bench
