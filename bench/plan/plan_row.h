#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// Comparison for one feature that a plan can omit. The general kernel, which includes the feature,
/// and the specialised kernel run alternately on one thread.
struct PlanRow {
  std::string module_name = {}, left_out = {}, scene = {};
  /// Unit of work to which the times refer: "path", "placement", "1 % error".
  std::string per = {};
  double general_s = 0, special_s = 0;  ///< CPU seconds, medians
  /// general_s / special_s: median and half the interquartile range.
  double ratio = 0, ratio_spread = 0;
  double difference = 0, limit = 0;  ///< difference of the results, and the largest one that passes
  /// Unit of `difference`: "relative", or "standard errors" if the kernels use different random
  /// numbers.
  std::string difference_in = {};
};

using PlanCase = std::function<PlanRow(double cpu_seconds)>;

/// Returns the comparisons of all modules: mc, transport, fields, fit, search, imaging, wave solver,
/// rays, render and design.
std::vector<PlanCase> plan_cases();

/// Whether the results of both kernels agree within the limit.
bool passes(const PlanRow& row);

}  // namespace flatspeckle::bench
