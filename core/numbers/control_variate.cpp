#include "core/numbers/control_variate.h"

namespace flatspeckle {

namespace {

/// Of each entry of theta, times the control's mean; 0 where it is left alone.
std::vector<double> coefficients(const GroupedSums& sums, const Estimator& theta,
                                 std::size_t control) {
  // of the variance: ten times what chance shows
  const double worthwhile = 10 / static_cast<double>(sums.groups());
  const double samples = sums.total_samples();
  const std::vector<Complex> total = sums.total(), mean = theta(samples, total);
  const double control_mean = total[control].real() / samples;
  std::vector<double> shared(mean.size()), square(mean.size());
  double control_square = 0;
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const double size = sums.group_samples(group);
    const auto of_group = sums.group_sums(group);
    const std::vector<Complex> value = theta(size, of_group);
    const double off = of_group[control].real() / size - control_mean;
    control_square += size * off * off;
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const double deviation = (value[i] - mean[i]).real();
      shared[i] += size * deviation * off;
      square[i] += size * deviation * deviation;
    }
  }
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const bool is_worth_it = shared[i] * shared[i] > worthwhile * square[i] * control_square;
    shared[i] = is_worth_it ? shared[i] / control_square : 0;
  }
  return shared;
}

}  // namespace

Estimate controlled_jackknife(const GroupedSums& sums, const Estimator& theta, std::size_t control,
                              double few) {
  constexpr std::size_t many = 32;
  if (sums.groups() < many) return jackknife(sums, theta, few);
  const auto of_control = coefficients(sums, theta, control);
  const auto controlled = [&](double samples, std::span<const Complex> all) {
    std::vector<Complex> value = theta(samples, all);
    for (std::size_t i = 0; i < value.size(); ++i)
      value[i] -= of_control[i] * all[control] / samples;
    return value;
  };
  return jackknife(sums, controlled, few);
}

}  // namespace flatspeckle
