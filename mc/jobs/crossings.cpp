#include "mc/jobs/crossings.h"

#include <algorithm>
#include <span>

namespace flatspeckle::mc {

std::vector<double> one_side(std::vector<double> steps) {
  const bool positive = std::ranges::any_of(steps, [](double step) { return step > 0; });
  for (double& step : steps) step = std::max(positive ? step : -step, 0.0);
  return steps;
}

std::vector<double> squared_correlation(std::span<const Complex> all, std::size_t channels,
                                        std::size_t channel) {
  const double now = all[channel].real();
  std::vector<double> squares;
  for (std::size_t i = channels + channel; i < all.size(); i += channels)
    squares.push_back(now > 0 ? std::norm(all[i] / now) : 0);
  return squares;
}

Crossings crossings(const CovarianceRequest& request, const PathJob& job, const GroupedSums& sums,
                    const std::vector<double>& steps, double level) {
  const std::size_t channels = request.entries.size();
  const std::vector<double> side = one_side(steps);
  const auto ranges = [&](double samples, std::span<const Complex> total) {
    const std::vector<Complex> all = job.all(samples, total);
    std::vector<Range> found;
    for (std::size_t c = 0; c < channels; ++c)
      found.push_back(DecayCurve(side, squared_correlation(all, channels, c)).crossing(level));
    return found;
  };
  Crossings found;
  found.value = jackknife(sums, [&](double samples, std::span<const Complex> total) {
    std::vector<Complex> values;
    for (const Range& range : ranges(samples, total)) values.emplace_back(range.value);
    return values;
  });
  const std::vector<Range> all = ranges(sums.total_samples(), sums.total());
  for (std::size_t c = 0; c < channels; ++c) {
    found.censored.push_back(static_cast<std::uint64_t>(all[c].censored));
    if (found.censored[c] != 0) found.value.error[c] = 0;
    found.few_steps |= few_steps(side, all[c]);
  }
  return found;
}

}  // namespace flatspeckle::mc
