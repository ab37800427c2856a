#pragma once

#include <span>

namespace flatspeckle::bench {

/// Fits y = amplitude x^exponent to at least two points, by weighted least squares of log y against
/// log x. The standard error of the exponent is estimated from the unweighted scatter of the points
/// about the line.
struct PowerFit {
  double exponent, amplitude, exponent_error;
};
PowerFit fit_power(std::span<const double> x, std::span<const double> y,
                   std::span<const double> weight);
PowerFit fit_power(std::span<const double> x, std::span<const double> y);

}  // namespace flatspeckle::bench
