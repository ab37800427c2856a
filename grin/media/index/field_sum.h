#pragma once

#include <tuple>
#include <utility>
#include <vector>

#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// n = 1 + the sum of the terms' excesses: any number of each kind, chosen at run time and without
/// a choice in the loop.
template <IndexField... Fields>
class FieldSum {
 public:
  template <IndexField F>
  FieldSum& add(F field) {
    std::get<std::vector<F>>(terms_).push_back(std::move(field));
    return *this;
  }

  double excess(const Vec3& x) const {
    double sum = 0;
    for_each([&](const auto& field) { sum += field.excess(x); });
    return sum;
  }
  IndexGradient gradient(const Vec3& x) const {
    IndexGradient sum{0, Vec3::Zero()};
    for_each([&](const auto& field) {
      const IndexGradient term = field.gradient(x);
      sum.excess += term.excess;
      sum.gradient += term.gradient;
    });
    return sum;
  }
  void gradients(const LaneVectors& x, LaneGradients& found) const {
    LaneGradients sum{};
    for_each([&](const auto& field) {
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
  IndexHessian hessian(const Vec3& x) const {
    IndexHessian sum{0, Vec3::Zero(), Mat3::Zero()};
    for_each([&](const auto& field) {
      const IndexHessian term = field.hessian(x);
      sum.excess += term.excess;
      sum.gradient += term.gradient;
      sum.hessian += term.hessian;
    });
    return sum;
  }

 private:
  template <class Visitor>
  void for_each(const Visitor& visit) const {
    std::apply(
        [&](const auto&... kind) {
          const auto visit_all = [&](const auto& fields) {
            for (const auto& field : fields) visit(field);
          };
          (visit_all(kind), ...);
        },
        terms_);
  }

  std::tuple<std::vector<Fields>...> terms_;
};

}  // namespace flatspeckle::grin
