#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/numbers/statistics.h"
#include "grin/render/sensors/sensor.h"
#include "grin/render/transport/film.h"

namespace flatspeckle::grin {

/// Powers on nested disks, from the same light paths.
struct PowersWithin {
  std::vector<double> radii;
  Estimate power;
  std::vector<double> covariance;  ///< covariance [disk][disk] of the errors
};

/// Returns the powers of a sensor that lists radii (RadialDetector), nullopt for others.
/// first_pixel: first pixel of the sensor in the sums of a batch. estimate: jackknife(), or a
/// better estimator.
std::optional<PowersWithin> powers_within(
    const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins, const GroupedSums& sums,
    const std::function<Estimate(const GroupedSums&, const Estimator&)>& estimate);

/// Returns the largest relative error of the powers. Each error is divided by the power on the
/// disk, or by a hundredth of the power of the lights if that is larger: dark disks need less
/// accuracy. Returns infinity if the power on the largest disk is less than twice its error, or
/// less than ten times its error if it is undersampled, since few paths that found little light do
/// not prove that the disk is dark.
double largest_error(const PowersWithin& powers, double power_of_light);

}  // namespace flatspeckle::grin
