#include "bench/measure/power_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace flatspeckle::bench {

namespace {

struct LogMoments {
  double weight = 0, x = 0, y = 0, xx = 0, xy = 0;  ///< means, then spreads about them
};

LogMoments log_moments(std::span<const double> x, std::span<const double> y,
                       std::span<const double> weight) {
  LogMoments m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    m.weight += weight[i];
    m.x += weight[i] * std::log(x[i]);
    m.y += weight[i] * std::log(y[i]);
  }
  m.x /= m.weight;
  m.y /= m.weight;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - m.x;
    m.xx += weight[i] * dx * dx;
    m.xy += weight[i] * dx * (std::log(y[i]) - m.y);
  }
  return m;
}

}  // namespace

PowerLaw fit_power(std::span<const double> x, std::span<const double> y,
                   std::span<const double> weight) {
  const LogMoments m = log_moments(x, y, weight);
  const double exponent = m.xy / m.xx;
  return {exponent, std::exp(m.y - exponent * m.x)};
}

PowerFit fit_power(std::span<const double> x, std::span<const double> y) {
  const std::vector<double> ones(x.size(), 1.0);
  const LogMoments m = log_moments(x, y, ones);
  const double exponent = m.xy / m.xx;
  double square = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = std::log(y[i]) - m.y - exponent * (std::log(x[i]) - m.x);
    square += off * off;
  }
  const double freedom = std::max(1.0, static_cast<double>(x.size()) - 2);
  return {exponent, std::sqrt(square / freedom / m.xx)};
}

}  // namespace flatspeckle::bench
