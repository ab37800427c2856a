#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// Cost of a task against the size of the problem.
struct CostCurve {
  std::string what, size_name;
  std::vector<double> size, cpu_s;
  double exponent = 0, exponent_error = 0;
  double expected = 0;                    ///< exponent for large sizes, from counting operations
  std::string cost_name = "CPU seconds";  ///< quantity stored in `cpu_s`
};

struct CostRun {
  std::string what;
  /// Measures the curve on the calling thread alone, in about this many CPU seconds.
  std::function<CostCurve(double cpu_seconds)> run;
};

/// Returns all cost measurements, which are independent and may run concurrently.
std::vector<CostRun> cost_runs();

}  // namespace flatspeckle::bench
