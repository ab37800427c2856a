#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin {

// Step types for trace() have two functions: advance(field, ray, tangent...) makes one step and
// returns its length h in sigma; step(field, h, ray, tangent...) repeats this step, or makes a part
// of it, from the same start.

template <class Integrator>
struct FixedSteps {
  double h;

  template <IndexField F, class... Tangent>
  static void step(const F& field, double h, RayState& ray, Tangent&... tangent) {
    Integrator::step(field, ray, tangent..., h);
  }
  template <IndexField F, class... Tangent>
  double advance(const F& field, RayState& ray, Tangent&... tangent) const {
    step(field, h, ray, tangent...);
    return h;
  }
};

/// Restores |v| = n(x), which steps preserve only to their order, and returns the difference
/// removed. Without this, an error of v^2 - n^2 would weigh q^-2 times as much after n has fallen
/// to q times its value along the ray. Sets x to NaN where the index is not above 0.
template <IndexField F>
double restore_index(const F& field, RayState& ray) {
  if constexpr (HomogeneousField<F>) return 0;
  const double n = index(field, ray.x), length = ray.v.norm();
  if (!(n > 0)) ray.x.setConstant(std::numeric_limits<double>::quiet_NaN());
  ray.v *= n / length;
  return std::abs(length - n);
}
/// Restores |v| = n(x) and updates the tangent map of the ray by the exact derivative of this
/// change.
template <IndexField F>
double restore_index(const F& field, RayState& ray, RayTangent& tangent) {
  if constexpr (HomogeneousField<F>) return 0;
  const IndexGradient at = field.gradient(ray.x);
  const double n = 1 + at.excess, length = ray.v.norm(), scale = n / length;
  const Vec3 along = ray.v / length;
  tangent.dv = (scale * (tangent.dv - along * (along.transpose() * tangent.dv)) +
                along * (at.gradient.transpose() * tangent.dx))
                   .eval();
  ray.v *= scale;
  return std::abs(length - n);
}

/// Makes two half steps and compares the result with one whole step. The estimated error is the
/// difference between the two results divided by 2^order - 1. It is kept below `tolerance`, for
/// positions relative to the length of the step and for directions as an angle. The error at the
/// end of a ray is then about tolerance times its length. Differences below the rounding of the
/// coordinates count as 0. The result of the two half steps is kept, and |v| = n is restored. A
/// tangent is the exact derivative of this result for the step lengths that the ray took.
template <class Integrator>
struct ControlledSteps {
  double tolerance;
  double h;        ///< length of the next step in sigma; the start value is arbitrary
  double longest;  ///< largest arc length of a step, so that no feature of the field is skipped
  /// Largest difference between |v| and n after a step, before |v| = n was restored.
  double index_mismatch = 0;

  /// Makes two half steps. Returns the difference between |v| and n before |v| = n is restored.
  template <IndexField F, class... Tangent>
  static double step(const F& field, double h, RayState& ray, Tangent&... tangent) {
    Integrator::step(field, ray, tangent..., h / 2);
    Integrator::step(field, ray, tangent..., h / 2);
    return restore_index(field, ray, tangent...);
  }

  /// Makes one step. A ray for which no step is short enough becomes NaN.
  template <IndexField F, class... Tangent>
  double advance(const F& field, RayState& ray, Tangent&... tangent) {
    const double longest_h = longest / ray.v.norm();
    for (int trial = 0; trial < 50; ++trial) {
      RayState halves = ray;
      double mismatch = 0;
      const double tried = std::min(h, longest_h),
                   error = tried_error(field, tried, ray, halves, mismatch);
      // NaN shortens the step too.
      const double factor = error <= tolerance * 1e9
                                ? 0.9 * std::pow(error / tolerance, -1.0 / Integrator::order)
                                : 0;
      h = tried * std::clamp(factor, 0.2, 4.0);
      if (!(error <= tolerance)) continue;
      index_mismatch = std::max(index_mismatch, mismatch);
      if constexpr (sizeof...(tangent) == 0)
        ray = halves;
      else
        step(field, tried, ray, tangent...);
      return tried;
    }
    ray.x.setConstant(std::numeric_limits<double>::quiet_NaN());
    ray.arc_length = std::numeric_limits<double>::quiet_NaN();
    return h;
  }

 private:
  /// Returns the estimated error of a step; NaN for a step shorter than the rounding of the
  /// coordinates.
  template <IndexField F>
  static double tried_error(const F& field, double h, const RayState& ray, RayState& halves,
                            double& mismatch) {
    RayState whole = ray;
    Integrator::step(field, whole, h);
    restore_index(field, whole);
    mismatch = step(field, h, halves);
    // restoring |v| = n at an index below 0 would reverse the ray
    if (!(halves.v.dot(ray.v) > 0)) return std::numeric_limits<double>::quiet_NaN();
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * halves.x.norm();
    const double length = ray.v.norm() * h;
    if (!(length > rounding)) return std::numeric_limits<double>::quiet_NaN();
    const double apart = std::max((whole.x - halves.x).norm() - rounding, 0.0);  // NaN is kept
    const double angle = (whole.v.normalized() - halves.v.normalized()).norm();
    return (apart / length + angle) / ((1 << Integrator::order) - 1);
  }
};

}  // namespace flatspeckle::grin
