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

// The cases of plan_cases(), by room.
std::vector<PlanCase> mc_plan_cases();
std::vector<PlanCase> transport_plan_cases();
std::vector<PlanCase> field_plan_cases();
std::vector<PlanCase> fit_plan_cases();
std::vector<PlanCase> imaging_plan_cases();
std::vector<PlanCase> wave_plan_cases();
std::vector<PlanCase> ray_plan_cases();
std::vector<PlanCase> render_plan_cases();
std::vector<PlanCase> design_plan_cases();

/// What a row is called.
struct PlanName {
  std::string room, left_out, scene, per;
};

/// Computes values, which another way must agree with.
using Way = std::function<std::vector<Complex>()>;
struct TwoWays {
  Way general, special;
};
/// Prepares what both ways share, smaller for a quick look.
using MakeWays = std::function<TwoWays(bool is_quick)>;
/// A case of values that must agree to a relative difference of `limit`. Its times are for one of
/// `count` things that a call makes.
PlanCase case_of_values(const PlanName& name, double limit, const MakeWays& make, int count = 1);

/// A kernel that makes numbered batches of samples.
struct SampledKernel {
  std::size_t size;  ///< sums per batch
  double samples_per_batch;
  std::function<void(std::uint64_t number, std::span<Complex> sums)> run;
  Estimator estimator;
};
struct TwoKernels {
  SampledKernel general, special;
};

enum class Draws { same, other };      ///< that two kernels draw
enum class Measure { sample, error };  ///< time per sample, or to an error of 1 %

/// A case of kernels that draw random numbers. Results are compared over a number of batches that
/// does not depend on the clock; of the same numbers they agree to rounding, of others within 4
/// standard errors.
PlanCase case_of_samples(const PlanName& name, Draws numbers, Measure measure,
                         const std::function<TwoKernels()>& make);

/// For a case of another form: `run` fills in the figures of its row.
PlanCase named(const PlanName& name,
               const std::function<void(PlanRow& row, double cpu_seconds)>& run);

/// Work done `calls` times; returns the CPU seconds of this thread that one call cost.
using Slice = std::function<double(int calls)>;
Slice timed(std::function<void()> work);

/// Fills in times and ratio: slices of both in turn, the order turned round from one to the next,
/// for about so many CPU seconds. fewest_calls: of a slice.
void compare_times(PlanRow& row, const Slice& general, const Slice& special, double cpu_seconds,
                   int fewest_calls = 1);

/// Fills in the difference in standard errors.
void compare_estimates(PlanRow& row, const Estimate& general, const Estimate& special);

}  // namespace flatspeckle::bench
