#pragma once

#include <cmath>

#include "grin/fields/index_field.h"

namespace flatspeckle::grin {

/// n = 1 + excess_at_origin + slope.x: positive on one side of a plane only.
struct LinearRamp {
  double excess_at_origin;
  Vec3 slope;

  double excess(const Vec3& x) const { return excess_at_origin + slope.dot(x); }
  IndexGradient gradient(const Vec3& x) const { return {excess(x), slope}; }
  IndexHessian hessian(const Vec3& x) const { return {excess(x), slope, Mat3::Zero()}; }
};

/// From excess `low` to excess `high` along the unit vector `axis`, as tanh of the distance from
/// the plane through `centre`, over about `width` to each side.
struct TanhRamp {
  double low, high, width;
  Vec3 axis = Vec3::UnitZ(), centre = Vec3::Zero();

  double excess(const Vec3& x) const { return low + (high - low) * fractions(x).above; }
  IndexGradient gradient(const Vec3& x) const {
    const auto [below, above] = fractions(x);
    return {low + (high - low) * above, first(below, above) * axis};
  }
  IndexHessian hessian(const Vec3& x) const {
    const auto [below, above] = fractions(x);
    const double slope = first(below, above);
    const Mat3 hessian = 2 / width * (below - above) * slope * axis * axis.transpose();
    return {low + (high - low) * above, slope * axis, hessian};
  }

 private:
  struct Fractions {
    double below, above;  ///< (1 -+ tanh)/2, each without cancellation
  };
  Fractions fractions(const Vec3& x) const {
    const double t = 2 * axis.dot(x - centre) / width;
    return {1 / (1 + std::exp(t)), 1 / (1 + std::exp(-t))};
  }
  double first(double below, double above) const {
    return 2 / width * (high - low) * below * above;
  }
};

}  // namespace flatspeckle::grin
