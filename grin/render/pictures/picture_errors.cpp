#include "grin/render/pictures/picture_errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace flatspeckle::grin {

namespace {

/// Returns, for each entry, the sum over the entry and its neighbours along one axis.
std::vector<double> sums_along(const std::vector<double>& values, std::size_t stride,
                               std::size_t length) {
  constexpr std::size_t reach = 2;
  std::vector<double> sums(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t place = i / stride % length;
    const std::size_t from = i - std::min(place, reach) * stride;
    const std::size_t to = i + std::min(length - 1 - place, reach) * stride;
    for (std::size_t k = from; k <= to; k += stride) sums[i] += values[k];
  }
  return sums;
}

std::vector<double> sums_around(const std::vector<double>& values, const PixelGrid& grid) {
  const auto rows = static_cast<std::size_t>(grid.rows);
  const auto columns = static_cast<std::size_t>(grid.columns);
  const std::size_t bins = values.size() / (rows * columns);
  return sums_along(sums_along(sums_along(values, 1, bins), bins, columns), bins * columns, rows);
}

/// Relative error above which an entry is undersampled: that of six contributions of one size.
/// Their sum is skewed, and where paths of high weight are rare, an estimate that lacks them has
/// too small an error. In a run of few groups their number shows this less reliably.
constexpr double rough_error = 0.4;

/// Error bound for contributions that may have been missed. Contributions of size c have a variance
/// of c times their sum, from which c follows. If three of them are expected, with sum 3 c, none
/// arrives with probability 1/20. As this is the probability of a deviation by two standard errors,
/// the error is 1.5 c.
double unseen(double variance, double sum) {
  return sum > 0 ? 1.5 * variance / sum : 0;
}

}  // namespace

double few_of_pixels(std::size_t groups) {
  constexpr double few = 12, events = 3, many = 216;  // groups without reduction by jackknife()
  const double all = static_cast<double>(groups);
  return std::max(few, std::min(events, all / 5) * many / all);
}

void bound_errors(Estimate& picture, const PixelGrid& grid) {
  const std::size_t size = picture.value.size();
  const std::vector<double> values = real_parts(picture.value);
  std::vector<double> variances(size), undersampled(size), undersampled_lit(size), lit(size);
  for (std::size_t i = 0; i < size; ++i) {
    const bool is_rare = picture.rare[i] || picture.error[i] > rough_error * std::abs(values[i]);
    variances[i] = picture.error[i] * picture.error[i];
    undersampled[i] = is_rare ? values[i] : 0;
    lit[i] = values[i] != 0;
    undersampled_lit[i] = is_rare ? lit[i] : 0;
  }
  const double of_all = unseen(std::reduce(variances.begin(), variances.end()),
                               std::reduce(values.begin(), values.end()));
  if (!std::isfinite(of_all)) return;  // there is only one batch
  const auto values_around = sums_around(values, grid);
  const auto variances_around = sums_around(variances, grid);
  const auto undersampled_around = sums_around(undersampled, grid);
  const auto undersampled_lit_around = sums_around(undersampled_lit, grid),
             lit_around = sums_around(lit, grid);
  for (std::size_t i = 0; i < size; ++i) {
    const double bound =
        values_around[i] > 0 ? unseen(variances_around[i], values_around[i]) : of_all;
    const bool is_rough = picture.error[i] > rough_error * std::abs(values[i]);
    const double mean_variance = variances_around[i] / std::max(lit_around[i], 1.0);
    const bool misses_events =
        undersampled_lit_around[i] > lit_around[i] / 8 && 4 * variances[i] < mean_variance;
    // Its few paths are weaker than those around it, and one of these would exceed its error.
    const bool misses_light = picture.rare[i] && picture.error[i] < bound;
    const bool is_known = values[i] != 0 && !is_rough && !misses_light && !misses_events &&
                          undersampled_around[i] <= values_around[i] / 2 &&
                          undersampled_lit_around[i] <= lit_around[i] / 2;
    const bool is_dark = values_around[i] == 0 && of_all > 0;
    picture.rare[i] = !is_known && !is_dark;
    if (is_known) continue;
    picture.error[i] = std::max(2 * picture.error[i], bound);
    if (misses_events) picture.error[i] = std::max(picture.error[i], std::sqrt(mean_variance));
  }
}

}  // namespace flatspeckle::grin
