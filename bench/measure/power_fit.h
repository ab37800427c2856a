#pragma once

#include <span>

namespace flatspeckle::bench {

/// y = amplitude x^exponent.
struct PowerLaw {
  double exponent, amplitude;
};

/// Least squares of log y against log x with these weights; two points or more.
PowerLaw fit_power(std::span<const double> x, std::span<const double> y,
                   std::span<const double> weight);

/// Equal weights, and the standard error of the exponent from the scatter about the line.
struct PowerFit {
  double exponent, exponent_error;
};
PowerFit fit_power(std::span<const double> x, std::span<const double> y);

}  // namespace flatspeckle::bench
