#pragma once

#include <cmath>
#include <numbers>

#include "grin/media/geometry/frame.h"
#include "grin/media/scattering/space_phases.h"
#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

/// Samples the directions of `count` copies of a path after scattering at one point. Each direction
/// follows the phase function. The first random number of each copy is stratified over the copies,
/// and successive azimuths differ by the golden angle.
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

  /// Returns the direction of the next copy. random: random stream of that copy.
  Vec3 next(RandomStream& random) {
    random.put_back(place_++ / count_);
    const double beside = phase_.one_minus_cosine(random);
    const Vec3 across = cosine_ * across_.col(0) + sine_ * across_.col(1);
    go_round();
    return unit_again((1 - beside) * before_ + std::sqrt(beside * (2 - beside)) * across);
  }

 private:
  /// Rotates the azimuth by the golden angle.
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

/// Systematic Russian roulette for a sequence of paths. The number of survivors is the sum of the
/// survival probabilities, rounded down or up.
class EvenTermination {
 public:
  explicit EvenTermination(RandomStream& random) : sum_(random.uniform()) {}

  /// Returns whether the next path survives, which has the given probability, below 1.
  bool keeps(double probability) {
    sum_ += probability;
    if (sum_ < 1) return false;
    sum_ -= 1;
    return true;
  }

 private:
  double sum_;
};

}  // namespace flatspeckle::grin
