#include "mc/jobs/contrast.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numbers/gauss.h"
#include "core/result/result_group.h"
#include "mc/jobs/decay_curve.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

}  // namespace

double exposed(const std::vector<double>& delays, const std::vector<double>& squares, double time) {
  const DecayCurve curve(delays, squares);
  const std::vector<double>& x = curve.roots();
  static const QuadratureRule rule = gauss_legendre(4);
  const double last = std::sqrt(time);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x.size() && x[i] < last; ++i) {
    const double width = std::min(x[i + 1], last) - x[i];
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      const double at = x[i] + width * rule.node[n];
      sum += width * rule.weight[n] * 2 * at * curve(at * at) * (1 - at * at / time);
    }
  }
  return 2 * sum / time;
}

std::vector<double> exposure_delays(const std::vector<double>& times) {
  constexpr double ratio = 1.5, below = 8;
  const auto [shortest, longest] = std::ranges::minmax(times);
  const double first = shortest / below;
  const auto steps = static_cast<int>(std::ceil(std::log(longest / first) / std::log(ratio)));
  std::vector<double> delays;
  for (int i = 0; i < steps; ++i)
    delays.push_back(first * std::pow(longest / first, static_cast<double>(i) / steps));
  delays.push_back(longest);
  return delays;
}

void check_exposure(const Exposure& exposure, const std::vector<double>& delays) {
  for (const double time : exposure.times) {
    const auto reaching =
        std::ranges::count_if(delays, [&](double delay) { return delay > 0 && delay < time; });
    const bool covered = std::ranges::any_of(delays, [&](double delay) { return delay >= time; });
    if (!covered || reaching < 4)
      throw InputError("exposures", time,
                       "must not exceed the longest delay; at least four delays above 0 must be "
                       "shorter than the exposure");
  }
}

Estimate squared_contrast(const CovarianceRequest& request, const PathJob& job,
                          const GroupedSums& sums, const std::vector<double>& delays,
                          const Exposure& exposure) {
  const std::size_t channels = request.entries.size();
  return jackknife(sums, [&](double samples, std::span<const Complex> total) {
    const Values all = job.all(samples, total);
    Values contrast;
    for (const double time : exposure.times)
      for (std::size_t c = 0; c < channels; ++c) {
        const double now = all[c].real();
        std::vector<double> squares;
        for (std::size_t t = 0; t < delays.size(); ++t)
          squares.push_back(now > 0 ? std::norm(all[(1 + t) * channels + c] / now) : 0);
        contrast.emplace_back(exposure.beta * exposed(delays, squares, time));
      }
    return contrast;
  });
}

const DatasetTable contrast_table{
    "contrast",
    {{"exposure", Data::scale, "", "DELAY", "exposure time, in the unit of the delays"},
     {"squared_contrast", Data::estimate, "exposure LIGHT VIEW", "1",
      "squared contrast K^2 of the speckle after an exposure"}},
    {{"squared_contrast", "beta", "float64", "K^2 of still scatterers"}}};

void write_contrast(ResultFile& file, const Exposure& exposure, const Estimate& contrast) {
  const ResultGroup root(file, contrast_table);
  root.put("exposure", exposure.times);
  root.put("squared_contrast", contrast);
  root.attribute("squared_contrast", "beta", exposure.beta);
}

}  // namespace flatspeckle::mc
