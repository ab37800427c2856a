#pragma once

#include <array>
#include <vector>

#include "grin/design/adjoint/designed_field.h"
#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin::design {

// Integration schemes for rays. A scheme is a symmetric sequence of drifts x += c h v and kicks v
// += d h n grad n, with numbers c and d, which begins and ends with a drift; h is the step length
// in sigma (C23). Integrated backwards, schemes retrace a ray up to rounding, so that derivatives
// need no stored path [teh2022].

/// Position-extended Forest-Ruth-like scheme [omelyan2002]. Its error is 1/100 of the error of the
/// fourth-order composition of three leapfrog steps.
struct Pefrl {
  static constexpr int order = 4;
  static constexpr double xi = 0.1786178958448091, lambda = -0.2123418310626054,
                          chi = -0.06626458266981849;
  static constexpr std::array<double, 5> drift{xi, chi, 1 - 2 * (chi + xi), chi, xi};
  static constexpr std::array<double, 4> kick{(1 - 2 * lambda) / 2, lambda, lambda,
                                              (1 - 2 * lambda) / 2};
};

template <class Scheme, IndexField F>
[[gnu::flatten]] void step(const F& field, RayState& ray, double h) {
  for (std::size_t i = 0; i < Scheme::kick.size(); ++i) {
    ray.x += Scheme::drift[i] * h * ray.v;
    const double k = Scheme::kick[i] * h;
    const RayForce at = ray_force(field, ray.x);
    ray.accumulate(1 + at.excess, k);
    ray.v += k * at.force;
  }
  ray.x += Scheme::drift.back() * h * ray.v;
}

/// Derivatives of the state of a ray after a step with respect to the length of the step.
struct RayRate {
  Vec3 x = Vec3::Zero(), v = Vec3::Zero();
  double arc_length = 0, optical_path = 0;
};

/// Makes a step and returns the exact derivative of the new state with respect to the step length
/// h.
template <class Scheme, IndexField F>
[[gnu::flatten]] RayRate step_with_rate(const F& field, RayState& ray, double h) {
  RayRate rate;
  const auto drift = [&](double c) {
    rate.x += c * (ray.v + h * rate.v);
    ray.x += c * h * ray.v;
  };
  for (std::size_t i = 0; i < Scheme::kick.size(); ++i) {
    drift(Scheme::drift[i]);
    const double d = Scheme::kick[i], k = d * h;
    const IndexHessian at = field.hessian(ray.x);
    const double n = 1 + at.excess, dn = at.gradient.dot(rate.x);
    ray.accumulate(n, k);
    rate.arc_length += d * n + k * dn;
    rate.optical_path += d * n * n + 2 * k * n * dn;
    rate.v += d * ray_force(at) + k * (ray_force_derivative(at) * rate.x);
    ray.v += k * ray_force(at);
  }
  drift(Scheme::drift.back());
  return rate;
}

/// Derivatives of K measurements of a ray with respect to its state (x, v, arc length, optical
/// path).
template <int K>
struct RayAdjoint {
  using Columns = Eigen::Matrix<double, 3, K>;
  using Row = Eigen::Matrix<double, 1, K>;
  Columns x = Columns::Zero(), v = Columns::Zero();
  Row arc_length = Row::Zero(), optical_path = Row::Zero();
};

/// Derivatives of K measurements with respect to all coefficients of the field, accumulated along
/// one ray at a time.
template <int K>
class CoefficientSums {
 public:
  explicit CoefficientSums(const CoefficientShape& shape)
      : shape_(shape), values_(K * shape.size(), 0.0), touched_(shape.rows(), 0) {}

  double* row(int k, int r) {
    touched_[r] = 1;
    return &values_[k * shape_.size() + static_cast<std::size_t>(r) * shape_.row_length()];
  }
  /// Calls use(i, derivatives) for each coefficient i on which any of the K measurements depends,
  /// and resets all derivatives to 0.
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

/// Reverses a kick of length k at x and propagates the adjoint, that is the derivatives of the
/// measurements, through it (conventions, C29).
template <int K, DesignedField F>
[[gnu::always_inline]] inline void undo_kick(const F& field, RayState& ray, RayAdjoint<K>& adjoint,
                                             CoefficientSums<K>& sums, double k) {
  const auto at = evaluate(field, ray.x);
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

/// Reverses an integration step and propagates the adjoint through it; exact for the discrete step.
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
