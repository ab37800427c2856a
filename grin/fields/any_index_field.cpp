#include "grin/fields/any_index_field.h"

namespace flatspeckle::grin {

double AnySum::excess(const Vec3& x) const {
  return sum_.excess(x);
}
IndexGradient AnySum::gradient(const Vec3& x) const {
  return sum_.gradient(x);
}
IndexHessian AnySum::hessian(const Vec3& x) const {
  return sum_.hessian(x);
}

}  // namespace flatspeckle::grin
