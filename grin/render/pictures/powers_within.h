#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/numbers/statistics.h"
#include "grin/render/sensors/sensor.h"
#include "grin/render/transport/film.h"

namespace flatspeckle::grin {

/// Powers on disks within each other, from the same light paths.
struct PowersWithin {
  std::vector<double> radii;
  Estimate power;
  std::vector<double> covariance;  ///< [disk][disk], of the errors
};

/// Of a sensor that lists radii (RadialDetector), whose first pixel is that of a batch's sums;
/// nothing of others. estimate: jackknife(), or what is better.
std::optional<PowersWithin> powers_within(
    const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins, const GroupedSums& sums,
    const std::function<Estimate(const GroupedSums&, const Estimator&)>& estimate);

/// The largest of the errors, each relative to its power or, if that is less, to a hundredth of the
/// light's: a disk on which hardly any light falls need not be known as well as the others.
/// Infinite where the power on the largest disk is not twice its error, or ten times that where a
/// few paths bring it: darkness is not known by not having found light.
double largest_error(const PowersWithin& powers, double power_of_light);

}  // namespace flatspeckle::grin
