#include "grin/render/pictures/powers_within.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatspeckle::grin {

namespace {

/// Returns the estimator of the powers within the outer edge of each ring. first: index of the sum
/// of the innermost ring.
Estimator nested_powers(std::vector<double> areas, std::size_t first) {
  return [=](double samples, std::span<const Complex> all) {
    std::vector<Complex> powers;
    Complex within = 0;
    for (std::size_t ring = 0; ring < areas.size(); ++ring) {
      within += areas[ring] * all[first + ring];
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

std::optional<PowersWithin> powers_within(const Sensor& sensor, const LightCheck& check,
                                          std::size_t first_pixel, const RenderJob& job,
                                          const GroupedSums& steady) {
  const auto* disks = std::get_if<RadialDetector>(&sensor);
  if (!disks || disks->radii.empty()) return std::nullopt;
  const PixelRings rings = picture_of(*disks);
  std::vector<double> areas;
  for (int ring = 0; ring < disks->rings; ++ring) areas.push_back(rings.area(ring));
  const Estimator theta = nested_powers(areas, job.first_steady() + first_pixel);
  PowersWithin found{disks->radii, job.estimate_of(check, steady, theta), {}};
  if (steady.groups() < 2) {
    found.covariance.assign(areas.size() * areas.size(), found.power.error.front());
    return found;
  }
  found.covariance = covariance_of_means(steady, theta, found.power.value);
  scale_to(found.power.error, found.covariance);
  return found;
}

double largest_error(const PowersWithin& powers) {
  constexpr double few = 10;  // required power of an undersampled disk, in units of its error
  double largest = 0;
  for (std::size_t i = 0; i < powers.radii.size(); ++i) {
    const double value = powers.power.value[i].real(), error = powers.power.error[i];
    const bool is_rare = !powers.power.rare.empty() && powers.power.rare[i] != 0;
    if (!(value > 0) || (is_rare && few * error > value))
      return std::numeric_limits<double>::infinity();
    largest = std::max(largest, error / value);
  }
  return largest;
}

}  // namespace flatspeckle::grin
