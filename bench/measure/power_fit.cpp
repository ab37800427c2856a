#include "bench/measure/power_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace flatspeckle::bench {

PowerFit fit_power(std::span<const double> x, std::span<const double> y,
                   std::span<const double> weight) {
  double sum = 0, mean_x = 0, mean_y = 0, xx = 0, xy = 0, square = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += weight[i];
    mean_x += weight[i] * std::log(x[i]);
    mean_y += weight[i] * std::log(y[i]);
  }
  mean_x /= sum;
  mean_y /= sum;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x;
    xx += weight[i] * dx * dx;
    xy += weight[i] * dx * (std::log(y[i]) - mean_y);
  }
  const double exponent = xy / xx;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = std::log(y[i]) - mean_y - exponent * (std::log(x[i]) - mean_x);
    square += off * off;
  }
  const double freedom = std::max(1.0, static_cast<double>(x.size()) - 2);
  return {exponent, std::exp(mean_y - exponent * mean_x), std::sqrt(square / freedom / xx)};
}

PowerFit fit_power(std::span<const double> x, std::span<const double> y) {
  return fit_power(x, y, std::vector<double>(x.size(), 1.0));
}

}  // namespace flatspeckle::bench
