#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/imaging/line_camera.h"
#include "mc/imaging/recovery/image_score.h"
#include "mc/imaging/unmixing/unmixing.h"

namespace flatspeckle::mc {

/// How bright points are in the frames of a medium, [frame][point], over their own brightness: a
/// pure function of the medium's number.
using BrightnessDraw = std::function<std::vector<double>(std::uint64_t medium)>;

/// Each point shines in a share `lit` of the frames, by chance.
BrightnessDraw random_subsets(std::size_t frames, std::size_t points, double lit,
                              std::uint64_t seed);

/// Light that makes points shine.
struct Excitation {
  BrightnessDraw draw;              ///< |u|^2 at each point over its mean over the points
  std::vector<double> correlation;  ///< C_I of the light at pairs of points (0, 1), (0, 2), ...
};

/// How it is drawn.
struct ExcitationTask {
  std::size_t frames = 1;
  std::uint64_t paths = 20000, seed = 1;
  int threads = 1;
};

/// Speckle of a plane wave that comes through the medium to the object's line, another in each
/// frame: Gaussian fields at the points, of the covariance that light paths have. medium: at the
/// light's wavelength. Alone, a point's brightness is distributed exponentially. Throws Interrupted
/// once a signal has come (catch_interrupts).
Excitation speckle_excitation(Scene medium, const LineScene& line, const ExcitationTask& task);

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
