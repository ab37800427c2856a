#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace flatspeckle::grin {

/// Phase functions of flatland (Dimension 2: per radian, scattering angle in (-pi, pi]) and of
/// space (Dimension 3: per steradian, polar angle in [0, pi], azimuth uniform and left to the
/// caller). sample() takes a uniform u in (0, 1).

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
/// 1941 in space. |g| < 1.
template <int Dimension>
struct HenyeyGreenstein {
  static_assert(Dimension == 2 || Dimension == 3);
  double g;

  double density_at(double cosine) const { return density_beside(1 - cosine); }
  /// By 1 - cosine, which keeps its digits in the peak of g near 1.
  double density_beside(double one_minus_cosine) const {
    // 1 + g^2 - 2 g cos, without its cancellation for g near 1
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
  /// Of the angle that sample(u) returns.
  double sample_one_minus_cosine(double u) const requires(Dimension == 3) {
    // the usual inverse, written so that nothing is divided by g or cancels
    const double s = 1 - g + 2 * g * u;
    return std::min(2.0, 2 * (1 - g) * (1 - g) * (1 - u) * (1 + g * u) / (s * s));
  }
};

/// A flatland phase function that is even in the angle, given at equally spaced angles and linear
/// between them; density and sampling are those of the table to rounding.
class TabulatedPhaseFunction {
 public:
  /// p is evaluated at `intervals`+1 angles from 0 to pi and normalised to integral 1 over 2 pi.
  TabulatedPhaseFunction(const std::function<double(double)>& p, std::size_t intervals);

  double density(double angle) const;
  double sample(double u) const;

 private:
  double step_;
  std::vector<double> density_;     ///< at the nodes
  std::vector<double> cumulative_;  ///< integral of 2 p from 0 to the node; ends at 1
};

}  // namespace flatspeckle::grin
