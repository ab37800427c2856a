#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/keys/keys.h"
#include "core/numbers/random.h"
#include "mc/theory/detector_noise.h"

namespace flatspeckle::mc {

/// Detector of a camera. An ideal one counts each photon.
struct Detector {
  double quantum_efficiency = 1;  ///< electrons per photon
  double full_well = 0;           ///< electrons at which a pixel saturates; 0: never
  std::int64_t bit_depth = 0;  ///< bits of a value, whose largest is full_well; 0: exact electrons

  /// Returns the electrons per unit of a frame's values.
  double step() const;
};
void add_keys(Keys& keys, Detector& detector);
/// Reads the keys. Throws InputError for a bit depth without full_well, or if there are no photons.
Detector detector_of(const Keys& keys, const Detector& detector, const CameraNoise& noise);

/// Returns the noise of the frames of a detector: that of its electrons, with the rounding of
/// values as read noise.
CameraNoise detected_noise(const CameraNoise& noise, const Detector& detector);

/// Adds background and noise to a frame of mean 1, and converts it to values of the detector:
/// electrons, or whole numbers if there is a bit depth. Without photons the frame keeps its unit.
/// Returns the number of saturated pixels.
std::size_t detect(std::vector<double>& frame, const CameraNoise& noise, const Detector& detector,
                   RandomStream& random);

/// Adds the background and noise of an ideal detector to a frame, in units of the light's mean.
void expose(std::vector<double>& frame, const CameraNoise& noise, RandomStream& random);

}  // namespace flatspeckle::mc
