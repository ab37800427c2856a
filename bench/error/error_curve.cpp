#include "bench/error/error_curve.h"

#include "bench/error/error_flatland.h"
#include "bench/error/error_render.h"

namespace flatspeckle::bench {

std::vector<ErrorRun> error_runs() {
  std::vector<ErrorRun> runs = flatland_error_runs();
  for (ErrorRun& run : render_error_runs()) runs.push_back(std::move(run));
  return runs;
}

}  // namespace flatspeckle::bench
