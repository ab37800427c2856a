#pragma once

#include <cstddef>
#include <vector>

#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

/// Positive curve that decays from 1 at x = 0, such as |g1|^2 over delays or C_I over frequencies,
/// given at some x. The logarithm of the curve is interpolated by cubic polynomials in the square
/// root of x. This is exact if the curve decays as exp(-x), exp(-sqrt(x)) or their product.
class DecayCurve {
 public:
  /// Values at x <= 0 are ignored. Values below 1e-300 count as 1e-300. If x occurs twice, its last
  /// value is used.
  DecayCurve(const std::vector<double>& x, const std::vector<double>& values);

  /// Returns the curve at x, which must be from 0 to last().
  double operator()(double x) const;
  double last() const;
  /// Returns the square roots of the x of the curve, in ascending order, beginning with 0.
  const std::vector<double>& roots() const { return root_; }

  /// Returns the smallest x at which the curve falls to the level, censored if it does not within
  /// the given values or if it has already fallen at the first one.
  Range crossing(double level) const;

  /// Returns the curve without every second value. The difference of the curves shows the error of
  /// interpolation.
  DecayCurve coarser() const;

 private:
  DecayCurve() = default;

  std::vector<double> root_, log_;
};

}  // namespace flatspeckle::mc
