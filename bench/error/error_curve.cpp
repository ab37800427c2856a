#include "bench/error/error_curve.h"

#include "bench/error/error_boxes.h"
#include "bench/error/error_design.h"
#include "bench/error/error_fit.h"
#include "bench/error/error_imaging.h"
#include "bench/error/error_render.h"
#include "bench/error/error_slabs.h"
#include "bench/error/error_varying.h"

namespace flatspeckle::bench {

std::vector<ErrorRun> error_runs() {
  std::vector<ErrorRun> runs = box_error_runs();
  for (const auto& more : {slab_error_runs(), varying_error_runs(), fit_error_runs(),
                           imaging_error_runs(), render_error_runs(), design_error_runs()})
    runs.insert(runs.end(), more.begin(), more.end());
  return runs;
}

}  // namespace flatspeckle::bench
