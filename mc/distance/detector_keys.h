#pragma once

#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "mc/distance/distance_job.h"

namespace flatspeckle::mc {

/// Values of the keys of detectors at distances from a beam.
struct DetectorValues {
  std::optional<double> detector_radius, ring_width;
  double numerical_aperture = 1, source_radius = 0;
};
void add_keys(Keys& keys, DetectorValues& values);

/// Returns a request with one detector at each of these distances. Throws InputError; key: name of
/// the distances in error messages.
DistanceRequest make_detectors(const Keys& keys, const DetectorValues& values,
                               const std::string& key, const std::vector<double>& distances);

}  // namespace flatspeckle::mc
