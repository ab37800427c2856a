#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/line_object.h"
#include "mc/imaging/unmixing/nonnegative_factors.h"
#include "mc/imaging/unmixing/source_count.h"
#include "mc/imaging/unmixing/source_places.h"

namespace flatspeckle::mc {

/// What is looked for in frames of one medium whose sources blink.
struct UnmixingTask {
  CameraNoise noise = {};        ///< of each frame
  std::size_t lags = 0;          ///< pixels: longer shifts of two patterns are not looked for
  std::size_t sources = 0;       ///< 0: as many as the singular values tell
  double resolution_grains = 1;  ///< shifts agree within so many
};

/// Sources from frames.
struct Unmixed {
  SourceCount count;
  NonnegativeFactors factors;
  SourcePlaces places;
  double grain = 0;  ///< of the patterns, pixels

  /// Of the largest group, in pixels; brightness: mean over the frames, the mean over the
  /// sources 1.
  LineObject object() const;
};

/// Frames of the same pixels. The factorisation (Zhu et al. 2022: fluctuating sources, patterns by
/// non-negative factors, places by their correlations) is of the light alone, in units of its mean.
/// Throws InputError for frames without light, as without_envelope(), and for fewer frames than
/// sources.
Unmixed unmixed(std::span<const std::vector<double>> frames, const UnmixingTask& task);

}  // namespace flatspeckle::mc
