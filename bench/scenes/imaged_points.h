#pragma once

#include <random>
#include <vector>

#include "mc/imaging/imaging.h"

namespace flatspeckle::bench {

/// A scene of four points behind five mean free paths of fog, viewed from afar.
inline mc::LineScene imaged_points() {
  SceneSpec spec;
  spec.width = 1000;
  spec.depth = 20;
  spec.scatterer = "hg";
  spec.g = 0.9;
  spec.optical_depth = 5;
  return mc::line_scene(make_scene(spec), {{0, 60, 150, 310}, {1, 1, 1, 1}}, -40000,
                        {std::nullopt, -0.5, 0.5, 2048});
}

/// Returns an autocorrelation with white noise, in which each pair of points at `marks` adds a peak
/// of height `signal` times the standard deviation of the noise.
inline mc::PairPeaks noisy_peaks(const std::vector<double>& marks, double signal, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  mc::PairPeaks peaks{.step = 1, .height = std::vector<double>(400), .noise = 1};
  peaks.alone = signal * static_cast<double>(marks.size());
  for (double& value : peaks.height) value = noise(random);
  for (const double a : marks)
    for (const double b : marks)
      if (a > b) peaks.height[static_cast<std::size_t>(a - b)] += signal;
  return peaks;
}

}  // namespace flatspeckle::bench
