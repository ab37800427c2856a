#pragma once

#include <cmath>
#include <utility>

#include "flatland/media/medium.h"
#include "grin/media/scattering/start_directions.h"
#include "mc/paths/endpoint_factors/scattering.h"

namespace flatspeckle::mc {

/// A unit vector in 3D, with y normal to the plane of incidence. Lights and views lie in the plane
/// y = 0. In a slab, only the x and z of positions and the x and z components of flights are
/// therefore computed.
struct SpaceDirection {
  double x = 0, y = 0, z = 1;

  SpaceDirection() = default;
  SpaceDirection(double along, double across, double deep) : x(along), y(across), z(deep) {}
  SpaceDirection(Vec2 in_plane) : x(in_plane.x), z(in_plane.z) {}
  operator Vec2() const { return {x, z}; }
};

inline SpaceDirection operator-(const SpaceDirection& a) {
  return {-a.x, -a.y, -a.z};
}
inline double dot(const SpaceDirection& a, const SpaceDirection& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double one_minus_cosine(const SpaceDirection& from, const SpaceDirection& to) {
  const SpaceDirection step(to.x - from.x, to.y - from.y, to.z - from.z);
  return step.y == 0 ? one_minus_cosine(Vec2(from), Vec2(to)) : dot(step, step) / 2;
}

/// Scattering (scattering.h) of scalar waves in 3D (conventions, C41).
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
