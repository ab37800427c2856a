#include "grin/media/fields/any_index_field.h"

#include "core/numbers/wide/every_width.h"

namespace flatspeckle::grin {

namespace {

/// Calls use(field) for each field in `terms`, a tuple of one vector for each kind of field.
template <class Vectors, class Use>
void each_term(const Vectors& terms, const Use& use) {
  const auto use_all = [&](const auto& fields) {
    for (const auto& field : fields) use(field);
  };
  std::apply([&](const auto&... fields) { (use_all(fields), ...); }, terms);
}

}  // namespace

double AnySum::excess(const Vec3& x) const {
  double sum = 0;
  each_term(terms_, [&](const auto& field) { sum += field.excess(x); });
  return sum;
}
IndexGradient AnySum::gradient(const Vec3& x) const {
  IndexGradient sum{0, Vec3::Zero()};
  each_term(terms_, [&](const auto& field) {
    const IndexGradient term = field.gradient(x);
    sum.excess += term.excess;
    sum.gradient += term.gradient;
  });
  return sum;
}
FLATSPECKLE_EVERY_WIDTH void AnySum::gradients(const LaneVectors& x, LaneGradients& found) const {
  LaneGradients sum{};
  each_term(terms_, [&](const auto& field) {
    LaneGradients term;
    lane_gradients(field, x, term);
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      sum.excess[k] += term.excess[k];
      sum.gradient.x[k] += term.gradient.x[k];
      sum.gradient.y[k] += term.gradient.y[k];
      sum.gradient.z[k] += term.gradient.z[k];
    }
  });
  found = sum;
}
IndexHessian AnySum::hessian(const Vec3& x) const {
  IndexHessian sum{0, Vec3::Zero(), Mat3::Zero()};
  each_term(terms_, [&](const auto& field) {
    const IndexHessian term = field.hessian(x);
    sum.excess += term.excess;
    sum.gradient += term.gradient;
    sum.hessian += term.hessian;
  });
  return sum;
}

}  // namespace flatspeckle::grin
