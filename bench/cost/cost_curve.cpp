#include "bench/cost/cost_curve.h"

#include "bench/cost/cost_rooms.h"

namespace flatspeckle::bench {

std::vector<CostRun> cost_runs() {
  std::vector<CostRun> runs;
  for (const auto& some : {wave_cost_runs(), transport_cost_runs(), ray_cost_runs()})
    runs.insert(runs.end(), some.begin(), some.end());
  return runs;
}

}  // namespace flatspeckle::bench
