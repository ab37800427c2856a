#pragma once

#include <array>

#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin::design {

// Symmetric compositions of drifts x += c h v and kicks v += d h n grad n: drift, kick, drift, ...,
// drift. Walked backwards they retrace a ray to the rounding, so that a derivative needs no
// storage.

struct LeapfrogScheme {
  static constexpr int order = 2;
  static constexpr std::array<double, 2> drift{0.5, 0.5};
  static constexpr std::array<double, 1> kick{1};
};

/// Omelyan, Mryglod and Folk 2002 ("position extended Forest-Ruth like"): a hundred times as exact
/// as three leapfrogs of order 4.
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
    ray.accumulate(ray.x, 1 + at.excess, k);
    ray.v += k * at.force;
  }
  ray.x += Scheme::drift.back() * h * ray.v;
}

/// A ray's change by the length of a step.
struct RayRate {
  Vec3 x = Vec3::Zero(), v = Vec3::Zero();
  double arc_length = 0, optical_path = 0;
};

/// A step, and its exact derivative by h.
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
    ray.accumulate(ray.x, n, k);
    rate.arc_length += d * n + k * dn;
    rate.optical_path += d * n * n + 2 * k * n * dn;
    rate.v += d * ray_force(at) + k * (ray_force_derivative(at) * rate.x);
    ray.v += k * ray_force(at);
  }
  drift(Scheme::drift.back());
  return rate;
}

}  // namespace flatspeckle::grin::design
