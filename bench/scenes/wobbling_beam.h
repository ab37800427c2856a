#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "core/numbers/random.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::bench {

/// Gaussian detector of width `width` in a unit square, and a beam around (0.3, 0.6) whose position
/// is random with the standard deviation `wobble` in each direction. The mean power on the detector
/// is largest at the middle of the beam and has a closed form.
struct WobblingBeam {
  double width = 0.1, wobble = 0.2;
  double scale = 1;  ///< factor on the power
  std::uint64_t seed = 1;
  std::size_t per_unit = 320;  ///< beam positions in a measurement of one unit of effort

  double mean_power(const UnitPlace& at) const {
    const double variance = width * width + wobble * wobble;
    return scale * width * width / variance * std::exp(-square_distance(at, 0, 0) / (2 * variance));
  }
  double largest_power() const { return mean_power({middle_x, middle_y}); }

  /// Measures the mean power from random beam positions, which all detectors of a draw share.
  Measured measured(const UnitPlace& at, const SearchEffort& effort) const {
    constexpr std::size_t blocks = 32;
    const auto count = static_cast<std::size_t>(
        std::ceil(static_cast<double>(per_unit) * effort.samples / blocks));
    RandomStream random(seed, effort.draw, count);
    std::array<double, blocks> mean{};
    Measured found;
    for (double& power : mean) {
      for (std::size_t i = 0; i < count; ++i) power += one_power(at, random);
      power /= static_cast<double>(count);
      found.value += power / blocks;
    }
    for (const double power : mean)
      found.without.push_back((blocks * found.value - power) / (blocks - 1));
    return found;
  }

  SearchTask task() const {
    SearchTask task{.dimensions = 2, .measure = {}};
    task.measure = [*this](const std::vector<SearchPlace>& places, const SearchEffort& effort) {
      std::vector<Measured> found;
      for (const SearchPlace& place : places) found.push_back(measured(place.at, effort));
      return found;
    };
    return task;
  }

 private:
  static constexpr double middle_x = 0.3, middle_y = 0.6;

  static double square_distance(const UnitPlace& at, double x, double y) {
    const double dx = at[0] - middle_x - x, dy = at[1] - middle_y - y;
    return dx * dx + dy * dy;
  }
  double one_power(const UnitPlace& at, RandomStream& random) const {
    const double r = wobble * std::sqrt(-2 * std::log(random.uniform())),
                 angle = 2 * std::numbers::pi * random.uniform();
    return scale * std::exp(-square_distance(at, r * std::cos(angle), r * std::sin(angle)) /
                            (2 * width * width));
  }
};

}  // namespace flatspeckle::bench
