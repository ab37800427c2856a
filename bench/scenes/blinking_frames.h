#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "mc/imaging/imaging.h"
#include "mc/imaging/separation/separation.h"

namespace flatspeckle::bench {

/// Frames of blinking sources with uncorrelated speckle patterns, each source on in half of the
/// frames.
struct BlinkingFrames {
  std::vector<std::vector<double>> patterns, frames;
};

/// Parameters of the frames.
struct BlinkingScene {
  std::size_t pixels = 400, frames = 40;
  std::vector<double> brightness{1, 1, 1, 1};
  mc::CameraNoise noise = {};
};

inline BlinkingFrames blinking_frames(const BlinkingScene& scene, unsigned seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<double> intensity;
  std::bernoulli_distribution bright(0.5);
  BlinkingFrames made;
  double mean = 0;
  for (const double b : scene.brightness) {
    std::vector<double> pattern(scene.pixels);
    for (double& value : pattern) value = intensity(random);
    made.patterns.push_back(std::move(pattern));
    mean += b / 2;
  }
  for (std::size_t f = 0; f < scene.frames; ++f) {
    std::vector<double> frame(scene.pixels);
    for (std::size_t s = 0; s < made.patterns.size(); ++s)
      if (bright(random))
        for (std::size_t p = 0; p < scene.pixels; ++p)
          frame[p] += scene.brightness[s] / mean * made.patterns[s][p];
    RandomStream stream(seed, static_cast<std::uint64_t>(Stream::camera), f);
    mc::expose(frame, scene.noise, stream);
    made.frames.push_back(std::move(frame));
  }
  return made;
}

/// For each true pattern, computes the RMS difference from the most similar recovered pattern,
/// divided by the RMS of the true one. Returns the RMS of these values over all true patterns.
inline double pattern_error(const BlinkingFrames& truth, const Eigen::MatrixXd& found) {
  double sum = 0;
  for (const auto& pattern : truth.patterns) {
    const Eigen::Map<const Eigen::VectorXd> own(pattern.data(), found.rows());
    double least = 1;
    for (Eigen::Index s = 0; s < found.cols(); ++s)
      least = std::min(least, (own - own.mean() * found.col(s)).squaredNorm() / own.squaredNorm());
    sum += least / static_cast<double>(truth.patterns.size());
  }
  return std::sqrt(sum);
}

}  // namespace flatspeckle::bench
