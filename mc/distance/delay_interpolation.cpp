#include "mc/distance/delay_interpolation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::mc {

DelayInterpolation::DelayInterpolation(std::span<const Complex> light, std::size_t detectors,
                                       int points)
    : delays_(light.size() / detectors), detectors_(detectors) {
  const auto log_light = [&](std::size_t delay, std::size_t detector) {
    return std::log(std::abs(light[delay * detectors + detector]));
  };
  const auto fallen = [&](std::size_t delay, std::size_t detector) {
    return log_light(0, detector) - log_light(delay, detector);
  };
  std::size_t darkest = 0;  // detector
  for (std::size_t d = 1; d < detectors; ++d)
    if (fallen(delays_ - 1, d) > fallen(delays_ - 1, darkest)) darkest = d;
  for (int k = 0; k < points; ++k) {
    const double share = (1 - std::cos(std::numbers::pi * k / (points - 1))) / 2,
                 target = share * fallen(delays_ - 1, darkest);
    std::size_t nearest = 0;
    for (std::size_t t = 1; t < delays_; ++t)
      if (std::abs(fallen(t, darkest) - target) < std::abs(fallen(nearest, darkest) - target))
        nearest = t;
    chosen_.push_back(nearest);
  }
  std::ranges::sort(chosen_);
  chosen_.erase(std::unique(chosen_.begin(), chosen_.end()), chosen_.end());
  for (std::size_t d = 0; d < detectors; ++d) {
    Eigen::MatrixXd& weights = weights_.emplace_back(delays_, chosen_.size());
    for (std::size_t t = 0; t < delays_; ++t)
      for (std::size_t j = 0; j < chosen_.size(); ++j) {
        const std::size_t own = chosen_[j];
        double weight = std::exp(log_light(t, d) - log_light(own, d));
        for (const std::size_t other : chosen_)
          if (other != own)
            weight *= (fallen(t, d) - fallen(other, d)) / (fallen(own, d) - fallen(other, d));
        weights(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(j)) = weight;
      }
  }
}

std::vector<Complex> DelayInterpolation::operator()(std::span<const Complex> at_chosen) const {
  const std::size_t size = chosen_.size(), parts = at_chosen.size() / (size * detectors_);
  std::vector<Complex> all;
  for (std::size_t part = 0; part < parts; ++part)
    for (std::size_t t = 0; t < delays_; ++t)
      for (std::size_t d = 0; d < detectors_; ++d) {
        Complex sum = 0;
        for (std::size_t j = 0; j < size; ++j)
          sum += weights_[d](static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(j)) *
                 at_chosen[(part * size + j) * detectors_ + d];
        all.push_back(sum);
      }
  return all;
}

}  // namespace flatspeckle::mc
