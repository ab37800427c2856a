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
#include "mc/imaging/separation/separation.h"

namespace flatspeckle::mc {

/// Function that returns the brightness of the points in all frames of one medium, [frame][point],
/// as a factor of the brightness of each point in the object. The result depends only on the number
/// of the medium.
using BrightnessDraw = std::function<std::vector<double>(std::uint64_t medium)>;

/// Returns a BrightnessDraw that lights each point in each frame with the probability `lit`,
/// independently of all others.
BrightnessDraw random_subsets(std::size_t frames, std::size_t points, double lit,
                              std::uint64_t seed);

/// Light that excites the points (fluorescence).
struct Excitation {
  BrightnessDraw draw;  ///< |u|^2 at each point, divided by its expected mean over the points
  /// C_I of the exciting light at pairs of points (0, 1), (0, 2), ...
  std::vector<double> correlation;
};

/// Settings for sampling the excitation.
struct ExcitationTask {
  std::size_t frames = 1;
  std::uint64_t paths = 20000, seed = 1;
  int threads = 1;
};

/// Returns the excitation by the speckle of a plane wave that is transmitted through the medium to
/// the line of the object, independent in each frame. The fields at the points are Gaussian, with a
/// covariance estimated from light paths. The brightness of each single point is therefore
/// distributed exponentially. medium: the medium at the wavelength of the excitation. Throws
/// Interrupted after a signal (catch_interrupts).
Excitation speckle_excitation(Scene medium, const LineScene& line, const ExcitationTask& task);

/// Settings for the frames of one medium if the brightness of the points varies between frames.
struct BlinkingTask {
  BrightnessDraw draw;  ///< empty: points do not blink
  std::size_t frames = 1;
  std::vector<double> correlation = {};  ///< Excitation::correlation, for excitation by speckle
  SeparationTask separation;
  bool separates = true;
};

/// Frames of one medium with varying brightness, and the sources separated from them.
struct Blinked {
  std::vector<std::vector<double>> frames;  ///< in units of the mean of the light over all frames
  std::vector<double> brightness;           ///< drawn brightness, [frame][point]
  double square = 0;                        ///< mean squared contrast of the frames
  /// Squared contrast expected for Gaussian speckle with the drawn brightness.
  double expected_square = 0;
  SeparatedSources found;
  ImageScore score;  ///< score of `found`, without mirroring
  /// For each point, the largest correlation of its speckle with any of the separated patterns.
  std::vector<double> pattern_match;
};

/// Simulates the frames of one medium and separates the sources. field: fields of the points in
/// this medium, [point][pixel].
Blinked blinked(const LineScene& line, const BlinkingTask& task, std::span<const Complex> field,
                std::uint64_t medium, std::uint64_t seed);

/// Returns the mean of all frames.
std::vector<double> mean_frame(const std::vector<std::vector<double>>& frames);

/// Returns the camera's noise in the mean of `frames` frames.
CameraNoise noise_of_mean(const CameraNoise& noise, std::size_t frames);

}  // namespace flatspeckle::mc
