#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/plan/plan_row.h"
#include "core/numbers/complex.h"
#include "core/numbers/statistics.h"

namespace flatspeckle::bench {

// The cases of plan_cases(), by module.
std::vector<PlanCase> mc_plan_cases();
std::vector<PlanCase> transport_plan_cases();
std::vector<PlanCase> field_plan_cases();
std::vector<PlanCase> fit_plan_cases();
std::vector<PlanCase> search_plan_cases();
std::vector<PlanCase> imaging_plan_cases();
std::vector<PlanCase> wave_plan_cases();
std::vector<PlanCase> ray_plan_cases();
std::vector<PlanCase> render_plan_cases();
std::vector<PlanCase> design_plan_cases();

/// Names in a PlanRow.
struct PlanName {
  std::string module_name, left_out, scene, per;
};

/// Computes the values that both alternatives must have in common.
using ValueFunction = std::function<std::vector<Complex>()>;
struct TwoAlternatives {
  ValueFunction general, special;
};
/// Prepares both alternatives. A quick run uses smaller problems.
using MakeAlternatives = std::function<TwoAlternatives(bool is_quick)>;
/// Makes a case from two functions whose values must agree to a relative difference of `limit`. One
/// call of a function performs `count` units of work; the times of the row are per unit.
PlanCase case_of_values(const PlanName& name, double limit, const MakeAlternatives& make,
                        int count = 1);

/// A Monte Carlo kernel, which samples numbered batches.
struct SampledKernel {
  std::size_t size;  ///< number of sums per batch
  double samples_per_batch;
  std::function<void(std::uint64_t number, std::span<Complex> sums)> run;
  Estimator estimator;
};
struct TwoKernels {
  SampledKernel general, special;
};

/// Whether both kernels use the same random numbers.
enum class Draws { same, other };
/// Whether times per sample or times to an error of 1 % are compared.
enum class Measure { sample, error };

/// Makes a case from kernels that use random numbers. Their results are compared over a fixed
/// number of batches, independent of the time spent. With the same random numbers the results must
/// agree to rounding, with different ones within 4 standard errors.
PlanCase case_of_samples(const PlanName& name, Draws numbers, Measure measure,
                         const std::function<TwoKernels()>& make);

/// Makes a case in which `run` fills in the times and the difference of the row.
PlanCase named(const PlanName& name,
               const std::function<void(PlanRow& row, double cpu_seconds)>& run);

/// Repeats a task `calls` times and returns this thread's CPU seconds per call.
using Slice = std::function<double(int calls)>;
Slice timed(std::function<void()> work);

/// Fills in the times and their ratio. Both kernels run in turn for about `cpu_seconds` in total;
/// which of them runs first alternates from round to round. fewest_calls: smallest number of calls
/// of a kernel in one round.
void compare_times(PlanRow& row, const Slice& general, const Slice& special, double cpu_seconds,
                   int fewest_calls = 1);

/// Fills in the largest difference of the two estimates, in combined standard errors.
void compare_estimates(PlanRow& row, const Estimate& general, const Estimate& special);

}  // namespace flatspeckle::bench
