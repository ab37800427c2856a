#include "grin/render/pictures/powers_within.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatspeckle::grin {

namespace {

/// Returns the estimator of the powers within the outer edge of each ring.
Estimator nested_powers(std::vector<double> areas, std::size_t first_pixel, const TimeBins& bins) {
  const auto stride = static_cast<std::size_t>(bins.sums());
  const auto parts = static_cast<std::size_t>(bins.parts());
  return [=](double samples, std::span<const Complex> all) {
    std::vector<Complex> powers;
    Complex within = 0;
    for (std::size_t ring = 0; ring < areas.size(); ++ring) {
      for (const Complex part : all.subspan((first_pixel + ring) * stride, parts))
        within += areas[ring] * part;
      powers.push_back(within / samples);
    }
    return powers;
  };
}

/// Returns the covariance of the means of theta, from its values for the single groups
/// (GroupedSums). The estimator theta must be linear in the sums.
std::vector<double> covariance_of_means(const GroupedSums& sums, const Estimator& theta,
                                        const std::vector<Complex>& mean) {
  const std::size_t count = mean.size();
  std::vector<double> covariance(count * count);
  const double samples = sums.total_samples();
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const double own = sums.group_samples(group), weight = own / (samples - own);
    const auto value = theta(own, sums.group_sums(group));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j)
        covariance[i * count + j] += weight * (value[i] - mean[i]).real() *
                                     (value[j] - mean[j]).real() /
                                     static_cast<double>(sums.groups());
  }
  return covariance;
}

/// Scales a covariance so that its diagonal agrees with the squares of the errors. These errors may
/// be smaller than those of plain means, for which the covariance was computed.
void scale_to(const std::vector<double>& errors, std::vector<double>& covariance) {
  const std::size_t count = errors.size();
  std::vector<double> factor;
  for (std::size_t i = 0; i < count; ++i) {
    const double variance = covariance[i * count + i];
    factor.push_back(variance > 0 ? errors[i] / std::sqrt(variance) : 0);
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j) covariance[i * count + j] *= factor[i] * factor[j];
}

}  // namespace

std::optional<PowersWithin> powers_within(
    const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins, const GroupedSums& sums,
    const std::function<Estimate(const GroupedSums&, const Estimator&)>& estimate) {
  const auto* disks = std::get_if<RadialDetector>(&sensor);
  if (!disks || disks->radii.empty()) return std::nullopt;
  const PixelRings rings = picture_of(*disks);
  std::vector<double> areas;
  for (int ring = 0; ring < disks->rings; ++ring) areas.push_back(rings.area(ring));
  const Estimator theta = nested_powers(areas, first_pixel, bins);
  PowersWithin found{disks->radii, estimate(sums, theta), {}};
  if (sums.groups() < 2) {
    found.covariance.assign(areas.size() * areas.size(), found.power.error.front());
    return found;
  }
  found.covariance = covariance_of_means(sums, theta, found.power.value);
  scale_to(found.power.error, found.covariance);
  return found;
}

double largest_error(const PowersWithin& powers, double power_of_light) {
  const double value = powers.power.value.back().real(), error = powers.power.error.back();
  // required power in units of its error
  const double least = powers.power.rare.back() == 0 ? 2 : 10;
  if (!(value > 0 && least * error < value)) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t i = 0; i < powers.radii.size(); ++i) {
    const double scale = std::max(powers.power.value[i].real(), 0.01 * power_of_light);
    largest = std::max(largest, powers.power.error[i] / scale);
  }
  return largest;
}

}  // namespace flatspeckle::grin
