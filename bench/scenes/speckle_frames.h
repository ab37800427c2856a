#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "core/frames/frames.h"
#include "mc/imaging/simulated/picture_frames.h"
#include "mc/imaging/simulated/picture_scene.h"
#include "mc/slab/adding/space.h"

namespace flatspeckle::bench {

/// Returns white noise averaged over Gaussians with a standard deviation of `width` pixels, on a
/// periodic square.
inline std::vector<double> smooth_noise(std::size_t side, double width, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<double> values(side * side), averaged(values.size());
  for (double& value : values) value = normal(random);
  const auto n = static_cast<long>(side), reach = static_cast<long>(std::ceil(3 * width));
  for (int axis = 0; axis < 2; ++axis) {
    for (long y = 0; y < n; ++y)
      for (long x = 0; x < n; ++x) {
        double sum = 0;
        for (long d = -reach; d <= reach; ++d)
          sum += std::exp(-std::pow(static_cast<double>(d) / width, 2) / 2) *
                 values[static_cast<std::size_t>(y * n + (x + d + n) % n)];
        averaged[static_cast<std::size_t>(x * n + y)] = sum;  // transposed
      }
    values.swap(averaged);
  }
  return values;
}

/// Returns the intensity of fully developed speckle, with a mean of 1.
inline std::vector<double> speckle_picture(std::size_t side, double width, std::mt19937& random) {
  const auto real = smooth_noise(side, width, random),
             imaginary = smooth_noise(side, width, random);
  std::vector<double> intensity(real.size());
  double mean = 0;
  for (std::size_t p = 0; p < intensity.size(); ++p) {
    intensity[p] = real[p] * real[p] + imaginary[p] * imaginary[p];
    mean += intensity[p] / static_cast<double>(intensity.size());
  }
  for (double& value : intensity) value /= mean;
  return intensity;
}

/// Returns frames, each of which is the mean of `patterns` independent speckle patterns, so that
/// K^2 is 1 / patterns.
inline Frames mixed_speckle(std::size_t count, std::size_t side, std::size_t patterns,
                            unsigned seed) {
  std::mt19937 random(seed);
  Frames frames{side, side, std::vector<double>(count * side * side), 0};
  for (std::size_t f = 0; f < count; ++f)
    for (std::size_t i = 0; i < patterns; ++i) {
      const auto one = speckle_picture(side, 1.2, random);
      for (std::size_t p = 0; p < one.size(); ++p)
        frames.values[f * one.size() + p] += one[p] / static_cast<double>(patterns);
    }
  return frames;
}

/// Returns frames of an object that share one speckle pattern per frame, shifted for each pixel of
/// the object, [y][x].
inline Frames shifted_speckle(std::size_t count, std::size_t side,
                              const std::vector<double>& object, std::size_t object_side,
                              unsigned seed) {
  std::mt19937 random(seed);
  Frames frames{side, side, std::vector<double>(count * side * side), 0};
  for (std::size_t f = 0; f < count; ++f) {
    const auto one = speckle_picture(side, 1.2, random);
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x)
        for (std::size_t o = 0; o < object.size(); ++o)
          if (object[o] > 0)
            frames.values[(f * side + (y + o / object_side) % side) * side +
                          (x + o % object_side) % side] += object[o] * one[y * side + x];
  }
  return frames;
}

/// Returns a letter F of 3 x 5 pixels, three pixels apart, on a square of `side` pixels.
inline std::vector<double> sparse_letter(std::size_t side) {
  std::vector<double> letter(side * side);
  for (const auto& [x, y] : std::vector<std::pair<std::size_t, std::size_t>>{
           {0, 0}, {1, 0}, {2, 0}, {0, 1}, {0, 2}, {1, 2}, {0, 3}, {0, 4}})
    letter[(2 + 3 * y) * side + 2 + 3 * x] = 1;
  return letter;
}

/// A scene in space of seven points at infinity behind five mean free paths of fog.
inline mc::PictureScene imaged_in_space() {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = spec.height = 100;
  spec.depth = 10;
  spec.scatterer = "hg";
  spec.g = 0.9;
  spec.optical_depth = 5;
  mc::PictureObject object;
  object.far = true;
  for (int i = -3; i <= 3; ++i) {
    object.place.push_back({0.008 * i, 0, 0.002 * i * i});
    object.brightness.push_back(1);
  }
  return mc::picture_scene(mc::in_space(make_scene(spec), spec), std::move(object),
                           {{0, 1, 0}, 0.1, 64});
}

}  // namespace flatspeckle::bench
