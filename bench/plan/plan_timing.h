#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "bench/plan/plan_row.h"
#include "core/numbers/complex.h"
#include "core/numbers/statistics.h"

namespace flatspeckle::bench {

/// Work done `calls` times; returns what one call cost.
using Slice = std::function<double(int calls)>;
/// The CPU seconds of this thread for a call of `work`.
Slice timed(std::function<void()> work);

/// Fills in times and ratio: slices of both in turn, the order turned round from one to the next,
/// for about so many CPU seconds. fewest_calls: of a slice.
void compare_times(PlanRow& row, const Slice& general, const Slice& special, double cpu_seconds,
                   int fewest_calls = 1);

/// Largest |a - b| relative to the largest |b|.
double relative_difference(std::span<const Complex> a, std::span<const Complex> b);

/// Largest |a - b| in combined standard errors.
double most_standard_errors(const Estimate& a, const Estimate& b);

/// Two ways to the same values.
using Values = std::function<std::vector<Complex>()>;
/// Fills in all figures of a row; `limit` is that of the relative difference.
void compare_values(PlanRow& row, const Values& general, const Values& special, double limit,
                    double cpu_seconds);

/// A kernel that makes numbered batches of samples.
struct SampledKernel {
  std::size_t size;  ///< sums per batch
  double samples_per_batch;
  std::function<void(std::uint64_t number, std::span<Complex> sums)> run;
  Estimator estimator;
};

enum class Numbers { same, other };    ///< that two kernels draw
enum class Measure { sample, error };  ///< time per sample, or to an error of 1 %

/// Fills in all figures of a row whose kernels draw random numbers. Results are compared over a
/// number of batches that does not depend on the clock; of the same numbers they agree to rounding,
/// of others within 4 standard errors.
void compare_sampled(PlanRow& row, const SampledKernel& general, const SampledKernel& special,
                     Numbers numbers, Measure measure, double cpu_seconds);

}  // namespace flatspeckle::bench
