#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::grin {

// What trace() goes by: advance(field, ray, tangent...) makes one step and returns its length h in
// sigma; step(field, h, ray, tangent...) repeats one, or a part of one, from the same start.

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

/// |v| = n(x) again, which steps keep to their order only. Returns by how much they differed. Where
/// n falls by a factor q on the way, what was lost of v^2 - n^2 before weighs q^-2 times as much.
/// NaN where the index is not above 0.
template <IndexField F>
double restore_index(const F& field, RayState& ray) {
  if constexpr (HomogeneousField<F>) return 0;
  const double n = index(field, ray.x), length = ray.v.norm();
  if (!(n > 0)) ray.x.setConstant(std::numeric_limits<double>::quiet_NaN());
  ray.v *= n / length;
  return std::abs(length - n);
}
/// The same with its exact derivative.
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

/// Two half steps, judged by one whole step: the error of the two, estimated as their difference /
/// (2^order - 1), is held below `tolerance`, in position relative to the step's length and in
/// direction as an angle, so that the error at the end of a ray is about tolerance times its
/// length; what is below the rounding of the coordinates is none. The two half steps are kept, and
/// |v| = n restored; a tangent is the exact derivative of that, for the step lengths that this ray
/// took.
template <class Integrator>
struct ControlledSteps {
  double tolerance;
  double h;                   ///< of the next step; start anywhere
  double longest;             ///< arc: steps grow no longer, so that nothing is jumped over
  double index_mismatch = 0;  ///< the largest ||v| - n| of its steps, before it was restored

  /// Returns ||v| - n| before it is restored.
  template <IndexField F, class... Tangent>
  static double step(const F& field, double h, RayState& ray, Tangent&... tangent) {
    Integrator::step(field, ray, tangent..., h / 2);
    Integrator::step(field, ray, tangent..., h / 2);
    return restore_index(field, ray, tangent...);
  }

  /// A ray that no step suits becomes NaN.
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
  /// NaN for a step so short that coordinates cannot tell it.
  template <IndexField F>
  static double tried_error(const F& field, double h, const RayState& ray, RayState& halves,
                            double& mismatch) {
    RayState whole = ray;
    Integrator::step(field, whole, h);
    restore_index(field, whole);
    mismatch = step(field, h, halves);
    // restored to an index below 0 a ray would turn round
    if (!(halves.v.dot(ray.v) > 0)) return std::numeric_limits<double>::quiet_NaN();
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * halves.x.norm();
    const double length = ray.v.norm() * h;
    if (!(length > rounding)) return std::numeric_limits<double>::quiet_NaN();
    const double apart = std::max((whole.x - halves.x).norm() - rounding, 0.0);  // NaN stays
    const double angle = (whole.v.normalized() - halves.v.normalized()).norm();
    return (apart / length + angle) / ((1 << Integrator::order) - 1);
  }
};

}  // namespace flatspeckle::grin
