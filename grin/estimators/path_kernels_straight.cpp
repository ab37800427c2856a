#include "grin/estimators/path_kernels_straight.h"

namespace flatspeckle::grin {

PathKernel straight_kernel_without_body(const RenderPlan& plan,
                                        std::shared_ptr<const Transport> transport, double excess) {
  return straight_kernel_of_body<false>(plan, transport, excess);
}

PathKernel straight_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                           double excess) {
  return plan.body ? straight_kernel_with_body(plan, transport, excess)
                   : straight_kernel_without_body(plan, transport, excess);
}

}  // namespace flatspeckle::grin
