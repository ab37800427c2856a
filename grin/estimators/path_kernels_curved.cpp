#include <numbers>

#include "grin/estimators/path_kernels_straight.h"
#include "grin/paths/bidirectional.h"

namespace flatspeckle::grin {

namespace {

template <RenderPlan plan>
PathKernel kernel_of(std::shared_ptr<const Transport> transport,
                     std::shared_ptr<const CurvedSpace> space, bool random_phase) {
  return [=](int paths, RandomStream& random, Film& film, TransportCounts& counts,
             JoinPromises* promises) {
    const auto add = [&](const CurvedSpace& met, int first, int last) {
      Bidirectional<plan, CurvedSpace> estimator(*transport, met, random, film, counts);
      for (int path = first; path < last; ++path) {
        estimator.add(stratum(path, paths, random));
        if (promises) estimator.append_promises(*promises);
      }
    };
    if (!random_phase) return add(*space, 0, paths);
    for (int path = 0; path < paths; ++path)
      add(*space->frozen(2 * std::numbers::pi * random.uniform()), path, path + 1);
  };
}

}  // namespace

PathKernel curved_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const CurvedSpace> space, bool random_phase) {
  return with_constant(plan.scatters, [&](auto scatters) {
    return with_constant(plan.timed, [&](auto timed) {
      return kernel_of<RenderPlan{true, scatters, true, true, true, timed, false}>(transport, space,
                                                                                   random_phase);
    });
  });
}

}  // namespace flatspeckle::grin
