#include "grin/media/fields/any_index_field.h"

#include "core/numbers/wide/every_width.h"

namespace flatspeckle::grin {

double AnySum::excess(const Vec3& x) const {
  return sum_.excess(x);
}
IndexGradient AnySum::gradient(const Vec3& x) const {
  return sum_.gradient(x);
}
FLATSPECKLE_EVERY_WIDTH void AnySum::gradients(const LaneVectors& x, LaneGradients& found) const {
  sum_.gradients(x, found);
}
IndexHessian AnySum::hessian(const Vec3& x) const {
  return sum_.hessian(x);
}

}  // namespace flatspeckle::grin
