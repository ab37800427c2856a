#include "bench/error_curve.h"

#include "bench/cost_curves.h"
#include "bench/error_flatland.h"
#include "bench/error_render.h"

namespace flatspeckle::bench {

std::vector<ErrorRun> error_runs() {
  std::vector<ErrorRun> runs = flatland_error_runs();
  for (ErrorRun& run : render_error_runs()) runs.push_back(std::move(run));
  return runs;
}

std::vector<CostRun> cost_runs() {
  std::vector<CostRun> runs;
  for (const auto& some : {wave_cost_runs(), transport_cost_runs(), ray_cost_runs()})
    runs.insert(runs.end(), some.begin(), some.end());
  return runs;
}

}  // namespace flatspeckle::bench
