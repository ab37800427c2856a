#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// One thing that a plan leaves out: the general kernel against the specialised one, in turn on one
/// thread.
struct PlanRow {
  std::string room = {}, left_out = {}, scene = {};
  std::string per = {};  ///< what the times are for: "path", "placement", "1 % error"
  double general_s = 0, special_s = 0;  ///< CPU seconds, medians
  double ratio = 0, ratio_spread = 0;   ///< general / special: median, half the quartiles' distance
  double difference = 0, limit = 0;     ///< of the results
  std::string difference_in = {};       ///< "relative"; "standard errors" where the two draw other
                                        ///< random numbers
};

using PlanCase = std::function<PlanRow(double cpu_seconds)>;

/// Rows of mc, transport, fields, fit, imaging, wave solver, rays and render.
std::vector<PlanCase> plan_cases();

/// Whether both kernels have the same result.
bool passes(const PlanRow& row);

}  // namespace flatspeckle::bench
