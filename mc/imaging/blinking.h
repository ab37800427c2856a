#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "mc/imaging/excitation.h"
#include "mc/imaging/line_camera.h"
#include "mc/imaging/recovery/image_score.h"
#include "mc/imaging/unmixing/unmixing.h"

namespace flatspeckle::mc {

/// Frames of one medium in which points differ in brightness.
struct BlinkingTask {
  BrightnessDraw draw;  ///< none: points do not blink
  std::size_t frames = 1;
  std::vector<double> correlation = {};  ///< as Excitation's, of excitation by speckle
  UnmixingTask unmixing;
  bool unmixes = true;
};

/// One medium.
struct Blinked {
  std::vector<std::vector<double>> frames;  ///< in units of the light's mean over all
  std::vector<double> brightness;           ///< [frame][point], the draw's
  double square = 0;                        ///< mean squared contrast of the frames
  double expected_square = 0;  ///< of Gaussian speckle of the brightness that was drawn
  Unmixed found;
  ImageScore score;  ///< not mirrored
  std::vector<double>
      pattern_match;  ///< of each point: correlation of its speckle with a pattern's
};

/// field: of the points in this medium, [point][pixel].
Blinked blinked(const LineScene& line, const BlinkingTask& task, std::span<const Complex> field,
                std::uint64_t medium, std::uint64_t seed);

/// The mean of all frames.
std::vector<double> mean_frame(const std::vector<std::vector<double>>& frames);

/// The camera's noise in the mean of so many frames.
CameraNoise noise_of_mean(const CameraNoise& noise, std::size_t frames);

}  // namespace flatspeckle::mc
