#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace flatspeckle::grin {

/// Phase functions of flatland (Dimension 2) and of space (Dimension 3). In flatland, densities are
/// per radian and the scattering angle is in (-pi, pi]. In space, densities are per steradian and
/// the angle is the polar angle in [0, pi]; the caller samples the uniform azimuth. sample() takes
/// a uniform u in (0, 1).

template <int Dimension>
struct Isotropic {
  static_assert(Dimension == 2 || Dimension == 3);
  static constexpr double value =
      Dimension == 2 ? 1 / (2 * std::numbers::pi) : 1 / (4 * std::numbers::pi);

  double density(double /*angle*/) const { return value; }
  double sample(double u) const {
    if constexpr (Dimension == 2) return 2 * std::numbers::pi * (u - 0.5);
    return std::acos(1 - 2 * u);
  }
};

/// Henyey-Greenstein: the wrapped Cauchy law in flatland (conventions, C22); Henyey and Greenstein
/// [henyey1941] in space. |g| < 1.
template <int Dimension>
struct HenyeyGreenstein {
  static_assert(Dimension == 2 || Dimension == 3);
  double g;

  double density_at(double cosine) const { return density_beside(1 - cosine); }
  /// Returns the density as a function of 1 - cosine. This keeps all digits in the forward peak for
  /// g near 1.
  double density_beside(double one_minus_cosine) const {
    // equals 1 + g^2 - 2 g cos, without cancellation for g near 1
    const double denominator = (1 - g) * (1 - g) + 2 * g * one_minus_cosine;
    const double numerator = (1 - g) * (1 + g) * Isotropic<Dimension>::value;
    if constexpr (Dimension == 2) return numerator / denominator;
    return numerator / (denominator * std::sqrt(denominator));
  }
  double density(double angle) const {
    const double half_sine = std::sin(angle / 2);
    return density_beside(2 * half_sine * half_sine);
  }
  double sample(double u) const {
    if constexpr (Dimension == 2)
      return 2 * std::atan((1 - g) / (1 + g) * std::tan(std::numbers::pi * (u - 0.5)));
    else
      return 2 * std::asin(std::sqrt(sample_one_minus_cosine(u) / 2));
  }
  /// Returns 1 - cosine of the angle that sample(u) returns.
  double sample_one_minus_cosine(double u) const requires(Dimension == 3) {
    // The usual inverse of the cumulative distribution, written without division by g and without
    // cancellation
    const double s = 1 - g + 2 * g * u;
    return std::min(2.0, 2 * (1 - g) * (1 - g) * (1 - u) * (1 + g * u) / (s * s));
  }
};

/// A flatland phase function that is even in the angle, given at equally spaced angles and linear
/// between them. Density and sampling agree with the table to rounding.
class TabulatedPhaseFunction {
 public:
  /// p is evaluated at `intervals` + 1 angles from 0 to pi and normalised so that its integral over
  /// 2 pi is 1.
  TabulatedPhaseFunction(const std::function<double(double)>& p, std::size_t intervals);

  double density(double angle) const;
  double sample(double u) const;

 private:
  double step_;
  std::vector<double> density_;  ///< density at the equally spaced angles
  /// Integral of 2 p from 0 to each of these angles. The last value is 1.
  std::vector<double> cumulative_;
};

}  // namespace flatspeckle::grin
