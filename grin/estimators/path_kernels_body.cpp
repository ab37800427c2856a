#include "grin/estimators/path_kernels_straight.h"

namespace flatspeckle::grin {

PathKernel straight_kernel_with_body(const RenderPlan& plan,
                                     std::shared_ptr<const Transport> transport, double excess) {
  return straight_kernel_of_body<true>(plan, transport, excess);
}

}  // namespace flatspeckle::grin
