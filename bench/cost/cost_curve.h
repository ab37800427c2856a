#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// Cost against problem size.
struct CostCurve {
  std::string what, size_name;
  std::vector<double> size, cpu_s;
  double exponent = 0, exponent_error = 0;
  double expected = 0;                    ///< by counting operations, for large sizes
  std::string cost_name = "CPU seconds";  ///< what `cpu_s` holds
};

struct CostRun {
  std::string what;
  /// On the calling thread alone, in about so many CPU seconds.
  std::function<CostCurve(double cpu_seconds)> run;
};

/// All of them: independent of each other, any of them at once.
std::vector<CostRun> cost_runs();

}  // namespace flatspeckle::bench
