#pragma once

#include <cmath>
#include <numbers>
#include <variant>

#include "grin/geometry/frame.h"
#include "grin/media/space_phases.h"

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
    const auto turn = [&](const auto& phase) { return phase.one_minus_cosine(random); };
    const double beside = std::visit(turn, phase_.which);
    const Vec3 across = cosine_ * across_.col(0) + sine_ * across_.col(1);
    const Vec3 turned = (1 - beside) * before_ + std::sqrt(beside * (2 - beside)) * across;
    go_round();
    return (1.5 - 0.5 * turned.squaredNorm()) * turned;  // lengths of long walks do not drift
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
