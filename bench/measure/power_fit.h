#pragma once

#include <span>

namespace flatspeckle::bench {

/// y = amplitude x^exponent, by least squares of log y against log x with these weights, two points
/// or more; and the standard error of the exponent from the scatter about the line, of equal
/// weights.
struct PowerFit {
  double exponent, amplitude, exponent_error;
};
PowerFit fit_power(std::span<const double> x, std::span<const double> y,
                   std::span<const double> weight);
PowerFit fit_power(std::span<const double> x, std::span<const double> y);

}  // namespace flatspeckle::bench
