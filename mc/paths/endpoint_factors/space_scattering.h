#pragma once

#include <cmath>
#include <utility>

#include "flatland/media/medium.h"
#include "grin/media/scattering/start_directions.h"
#include "mc/paths/endpoint_factors/space_direction.h"

namespace flatspeckle::mc {

/// Scattering (scattering.h) of scalar waves in space (conventions, C41).
class SpaceScattering {
 public:
  using Direction = SpaceDirection;

  explicit SpaceScattering(SpacePhase phase) : phase_(std::move(phase)) {}

  double density(const Direction& from, const Direction& to) const {
    return phase_.density(dot(from, to));
  }
  double amplitude(const Direction& from, const Direction& to) const {
    return std::sqrt(density(from, to));
  }
  void towards(const Direction& from, const Directions& to, std::span<Complex> out) const {
    for (std::size_t j = 0; j < out.size(); ++j) out[j] *= amplitude(from, to[j]);
  }
  Direction sample(const Direction& from, RandomStream& random) const {
    const double turn = phase_.one_minus_cosine(random);
    const grin::Vec3 to = grin::random_turn({from.x, from.y, from.z}, turn, random);
    return {to[0], to[1], to[2]};
  }

 private:
  SpacePhase phase_;
};

}  // namespace flatspeckle::mc
