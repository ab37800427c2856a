#pragma once

#include <cmath>
#include <numbers>

#include "grin/media/geometry/frame.h"
#include "grin/media/scattering/space_phases.h"
#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

/// Directions into which `count` copies of light scatter at one place, each by the phase function:
/// the first number that it draws is of an own stratum, and azimuths are a golden angle apart.
class EvenTurns {
 public:
  EvenTurns(const SpacePhaseFunction& phase, const Vec3& direction, double count,
            RandomStream& random)
      : phase_(phase),
        before_(direction),
        across_(frame_across(direction)),
        count_(count),
        place_(random.uniform()) {
    const double azimuth = 2 * std::numbers::pi * random.uniform();
    cosine_ = std::cos(azimuth);
    sine_ = std::sin(azimuth);
  }

  /// Of the next copy; random: its numbers.
  Vec3 next(RandomStream& random) {
    random.put_back(place_++ / count_);
    const double beside = phase_.one_minus_cosine(random);
    const Vec3 across = cosine_ * across_.col(0) + sine_ * across_.col(1);
    go_round();
    return unit_again((1 - beside) * before_ + std::sqrt(beside * (2 - beside)) * across);
  }

 private:
  /// By the golden angle.
  void go_round() {
    constexpr double c = -0.73736887807831990, s = 0.67549029426152365;
    const double cosine = c * cosine_ - s * sine_;
    sine_ = s * cosine_ + c * sine_;
    cosine_ = cosine;
  }

  const SpacePhaseFunction& phase_;
  Vec3 before_;
  Frame across_;
  double count_, place_, cosine_, sine_;
};

/// Roulette of many whose chances add up: as many stay as that sum, to the whole number before or
/// after it.
class EvenRoulette {
 public:
  explicit EvenRoulette(RandomStream& random) : sum_(random.uniform()) {}

  /// chance: below 1.
  bool keeps(double chance) {
    sum_ += chance;
    if (sum_ < 1) return false;
    sum_ -= 1;
    return true;
  }

 private:
  double sum_;
};

}  // namespace flatspeckle::grin
