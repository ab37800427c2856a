#pragma once

#include <vector>

#include "grin/design/adjoint/designed_field.h"
#include "grin/design/adjoint/scheme.h"

namespace flatspeckle::grin::design {

/// Derivatives of K numbers by the state of a ray.
template <int K>
struct RayAdjoint {
  using Columns = Eigen::Matrix<double, 3, K>;
  using Row = Eigen::Matrix<double, 1, K>;
  Columns x = Columns::Zero(), v = Columns::Zero();
  Row arc_length = Row::Zero(), optical_path = Row::Zero();
};

/// Derivatives of K numbers by all coefficients, summed up along one ray after another.
template <int K>
class CoefficientSums {
 public:
  explicit CoefficientSums(const CoefficientShape& shape)
      : shape_(shape), values_(K * shape.size(), 0.0), touched_(shape.rows(), 0) {}

  double* row(int k, int r) {
    touched_[r] = 1;
    return &values_[k * shape_.size() + static_cast<std::size_t>(r) * shape_.row_length()];
  }
  /// use(number of a coefficient, its K derivatives) of each that is not 0, and sets all to 0.
  template <class Use>
  void take(const Use& use) {
    for (int r = 0; r < shape_.rows(); ++r) {
      if (!touched_[r]) continue;
      touched_[r] = 0;
      const std::size_t begin = static_cast<std::size_t>(r) * shape_.row_length();
      for (int i = 0; i < shape_.row_length(); ++i) take_one(begin + i, use);
    }
  }

 private:
  template <class Use>
  void take_one(std::size_t number, const Use& use) {
    std::array<double, K> derivatives;
    bool any = false;
    for (int k = 0; k < K; ++k) {
      double& value = values_[k * shape_.size() + number];
      any = any || value != 0;
      derivatives[k] = std::exchange(value, 0.0);
    }
    if (any) use(number, derivatives);
  }

  CoefficientShape shape_;
  std::vector<double> values_;
  std::vector<char> touched_;
};

namespace adjoint_parts {

/// Back through a kick of weight k at x (conventions, C29).
template <int K, DesignedField F>
[[gnu::always_inline]] inline void undo_kick(const F& field, RayState& ray, RayAdjoint<K>& adjoint,
                                             CoefficientSums<K>& sums, double k) {
  const auto at = look(field, ray.x);
  const IndexHessian& jet = at.jet;
  const double n = 1 + jet.excess;
  ray.v -= k * n * jet.gradient;
  ray.arc_length -= k * n;
  ray.optical_path -= k * n * n;
  using Row = typename RayAdjoint<K>::Row;
  const Row a = k * (jet.gradient.transpose() * adjoint.v + 2 * n * adjoint.optical_path +
                     adjoint.arc_length);
  for (int c = 0; c < K; ++c)
    add_derivative(field, at, a[c], (k * n * adjoint.v.col(c)).eval(),
                   [&](int r) { return sums.row(c, r); });
  adjoint.x += jet.gradient * a + (k * n) * (jet.hessian * adjoint.v);
}

}  // namespace adjoint_parts

/// Walks a step back, and the derivatives with it: exact for the discrete step.
template <class Scheme, int K, DesignedField F>
[[gnu::flatten]] void step_back(const F& field, RayState& ray, RayAdjoint<K>& adjoint,
                                CoefficientSums<K>& sums, double h) {
  const auto drift = [&](double c) {
    ray.x -= c * h * ray.v;
    adjoint.v += c * h * adjoint.x;
  };
  for (std::size_t i = Scheme::kick.size(); i-- > 0;) {
    drift(Scheme::drift[i + 1]);
    adjoint_parts::undo_kick(field, ray, adjoint, sums, Scheme::kick[i] * h);
  }
  drift(Scheme::drift[0]);
}

}  // namespace flatspeckle::grin::design
