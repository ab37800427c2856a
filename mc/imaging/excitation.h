#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/imaging/line_camera.h"

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
/// light's wavelength. Alone, a point's brightness is distributed exponentially. Nothing where a
/// signal came.
std::optional<Excitation> speckle_excitation(Scene medium, const LineScene& line,
                                             const ExcitationTask& task);

}  // namespace flatspeckle::mc
