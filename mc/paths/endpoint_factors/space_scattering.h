#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "flatland/media/medium.h"
#include "grin/media/scattering/start_directions.h"
#include "grin/media/scattering/table_phase.h"
#include "mc/paths/endpoint_factors/scattering.h"

namespace flatspeckle::mc {

/// Rotates w by an angle, given by its 1 - cosine, towards a random azimuth.
inline Vec turned_in_space(Vec w, double one_minus_cosine, RandomStream& random) {
  const grin::Vec3 to = grin::random_turn({w.x, w.y, w.z}, one_minus_cosine, random);
  return {to[0], to[2], to[1]};
}

/// Scattering (scattering.h) of scalar waves in 3D (conventions, C41).
class SpaceScattering {
 public:
  explicit SpaceScattering(SpacePhase phase) : phase_(std::move(phase)) {}

  double density(Vec from, Vec to) const { return phase_.density(dot(from, to)); }
  double amplitude(Vec from, Vec to) const { return std::sqrt(density(from, to)); }
  void towards(Vec from, const Directions& to, std::span<Complex> out) const {
    for (std::size_t j = 0; j < out.size(); ++j) out[j] *= amplitude(from, to[j]);
  }
  Vec sample(Vec from, RandomStream& random) const {
    return turned_in_space(from, phase_.one_minus_cosine(random), random);
  }

 private:
  SpacePhase phase_;
};

/// Scattering in space by the Henyey-Greenstein function (C58).
struct HenyeyGreensteinInSpace {
  grin::HenyeyGreenstein<3> phase;

  double density(Vec from, Vec to) const {
    return phase.density_beside(one_minus_cosine(from, to));
  }
  double amplitude(Vec from, Vec to) const { return std::sqrt(density(from, to)); }
  void towards(Vec from, const Directions& to, std::span<Complex> out) const {
    multiply_by_amplitudes(*this, from, to, out);
  }
  Vec sample(Vec from, RandomStream& random) const {
    return turned_in_space(from, phase.sample_one_minus_cosine(random.uniform()), random);
  }
};

/// Scattering in space by a tabulated amplitude, linear in the angle between the nodes: the complex
/// amplitude of spheres (C57), or the square root of a phase function that is slow to compute.
class TabulatedSpaceScattering {
 public:
  /// amplitudes: at equal steps of the scattering angle from 0 to pi, in any unit.
  explicit TabulatedSpaceScattering(std::vector<Complex> amplitudes)
      : phase_(grin::phase_of_amplitudes(amplitudes)), amplitude_(std::move(amplitudes)) {
    const double scale = std::sqrt(phase_.density(1) / std::norm(amplitude_.front()));
    for (Complex& value : amplitude_) value *= scale;
  }

  double density(Vec from, Vec to) const { return phase_.density(dot(from, to)); }
  Complex amplitude(Vec from, Vec to) const {
    const double half_sine = std::sqrt(one_minus_cosine(from, to) / 2),
                 angle = 2 * std::asin(std::min(1.0, half_sine)),
                 position = angle / std::numbers::pi * static_cast<double>(amplitude_.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(position), amplitude_.size() - 2);
    const double t = position - static_cast<double>(i);
    return (1 - t) * amplitude_[i] + t * amplitude_[i + 1];
  }
  void towards(Vec from, const Directions& to, std::span<Complex> out) const {
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = product(out[j], amplitude(from, to[j]));
  }
  Vec sample(Vec from, RandomStream& random) const {
    return turned_in_space(from, phase_.one_minus_cosine(random), random);
  }

 private:
  grin::TablePhase phase_;
  std::vector<Complex> amplitude_;
};

}  // namespace flatspeckle::mc
