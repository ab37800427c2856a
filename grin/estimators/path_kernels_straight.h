#pragma once

#include "grin/estimators/path_kernels.h"
#include "grin/paths/bidirectional.h"
#include "grin/straight/straight_space.h"

namespace flatspeckle::grin {

/// Calls use(std::true_type or std::false_type).
template <class Use>
auto with_constant(bool value, const Use& use) {
  return value ? use(std::true_type()) : use(std::false_type());
}

/// Sensor paths take the pixels in turn.
inline double stratum(int path, int paths, RandomStream& random) {
  return (path + random.uniform()) / paths;
}

template <RenderPlan plan>
PathKernel straight_kernel_of(std::shared_ptr<const Transport> transport, double excess) {
  auto space = std::make_shared<const StraightSpace<plan>>(transport->stage, excess);
  return [=](int paths, RandomStream& random, Film& film, TransportCounts& counts,
             JoinPromises* promises) {
    Bidirectional<plan, StraightSpace<plan>> estimator(*transport, *space, random, film, counts);
    for (int path = 0; path < paths; ++path) {
      estimator.add(stratum(path, paths, random));
      if (promises) estimator.append_promises(*promises);
    }
  };
}

// One file each, so that they are compiled side by side.
PathKernel straight_kernel_without_body(const RenderPlan& plan,
                                        std::shared_ptr<const Transport> transport, double excess);
PathKernel straight_kernel_with_body(const RenderPlan& plan,
                                     std::shared_ptr<const Transport> transport, double excess);

template <bool body>
PathKernel straight_kernel_of_body(const RenderPlan& plan,
                                   std::shared_ptr<const Transport> transport, double excess) {
  return with_constant(plan.timed, [&](auto timed) {
    if (plan.deep)
      return with_constant(plan.gridded, [&](auto gridded) {
        return straight_kernel_of<RenderPlan{false, true, true, gridded, body, timed, true}>(
            transport, excess);
      });
    if (plan.gridded)
      return straight_kernel_of<RenderPlan{false, true, true, true, body, timed, false}>(transport,
                                                                                         excess);
    return with_constant(plan.scatters, [&](auto scatters) {
      return with_constant(plan.absorbs, [&](auto absorbs) {
        return straight_kernel_of<RenderPlan{false, scatters, absorbs, false, body, timed, false}>(
            transport, excess);
      });
    });
  });
}

}  // namespace flatspeckle::grin
