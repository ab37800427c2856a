#pragma once

#include <optional>
#include <vector>

#include "core/numbers/statistics.h"
#include "grin/render/pictures/render_job.h"
#include "grin/render/sensors/sensor.h"

namespace flatspeckle::grin {

/// Powers on nested disks, from the same light paths.
struct PowersWithin {
  std::vector<double> radii;
  Estimate power;
  std::vector<double> covariance;  ///< covariance [disk][disk] of the errors
};

/// Returns the powers of a sensor that lists radii (RadialDetector), nullopt for others. check:
/// check of the sensor; first_pixel: number of its first pixel; steady:
/// steady_sums().
std::optional<PowersWithin> powers_within(const Sensor& sensor, const LightCheck& check,
                                          std::size_t first_pixel, const RenderJob& job,
                                          const GroupedSums& steady);

/// Returns the largest relative error of the powers; infinity if a power is 0 or less than ten
/// times its error while undersampled, since few paths that found little light do not prove that
/// the disk is dark.
double largest_error(const PowersWithin& powers);

}  // namespace flatspeckle::grin
