#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "flatland/media/medium.h"
#include "grin/media/scattering/start_directions.h"
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

/// Scattering in space by points.
struct IsotropicInSpace {
  static constexpr grin::Isotropic<3> phase{};

  double density(Vec, Vec) const { return phase.value; }
  double amplitude(Vec, Vec) const { return std::sqrt(phase.value); }
  void towards(Vec, const Directions&, std::span<Complex> out) const {
    const double a = std::sqrt(phase.value);
    for (Complex& value : out) value *= a;
  }
  /// Maps a uniform point of the unit disk to a uniform point of the sphere.
  Vec sample(Vec, RandomStream& random) const {
    const Vec uniform = sample_disk(random);
    const double square = dot(uniform, uniform), across = 2 * std::sqrt(1 - square);
    return {across * uniform.x, 1 - 2 * square, across * uniform.z};
  }
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

/// Scattering in space by a tabulated amplitude: the complex amplitude of spheres (C57), or the
/// square root of a phase function that is slow to compute. The amplitude is linear between nodes
/// that are equally spaced in sin(angle / 2) up to pi/2, and in cos(angle / 2) beyond, so that the
/// position of an angle in the table is found by one square root.
class TabulatedSpaceScattering {
 public:
  /// amplitudes: at equal steps of the scattering angle from 0 to pi, in any unit.
  explicit TabulatedSpaceScattering(const std::vector<Complex>& amplitudes);

  double density(Vec from, Vec to) const { return std::norm(amplitude(from, to)); }
  Complex amplitude(Vec from, Vec to) const { return at(position(from, to)); }
  void towards(Vec from, const Directions& to, std::span<Complex> out) const {
    // Positions are computed in a separate loop, which the compiler can vectorise
    constexpr std::size_t most = 128;
    std::array<double, most> positions;
    for (std::size_t begin = 0; begin < out.size(); begin += most) {
      const std::size_t count = std::min(most, out.size() - begin);
      for (std::size_t j = 0; j < count; ++j) positions[j] = position(from, to[begin + j]);
      for (std::size_t j = 0; j < count; ++j)
        out[begin + j] = product(out[begin + j], at(positions[j]));
    }
  }
  Vec sample(Vec from, RandomStream& random) const;

 private:
  /// Returns the position of a scattering angle in the table, in units of its intervals.
  double position(Vec from, Vec to) const {
    const double t = one_minus_cosine(from, to) / 2, back = std::max(0.0, 1 - t);
    const double half = std::sqrt(2 * std::min(t, back));
    return middle_ * (t < back ? half : 2 - half);
  }
  Complex at(double position) const {
    const std::size_t i = std::min(static_cast<std::size_t>(position), amplitude_.size() - 2);
    const double t = position - static_cast<double>(i);
    return (1 - t) * amplitude_[i] + t * amplitude_[i + 1];
  }
  /// Returns sin^2(angle / 2) at node i.
  double half_sine_square(std::size_t i) const;

  double middle_;                     ///< number of intervals up to pi/2
  std::vector<Complex> amplitude_;    ///< at the nodes, divided by sqrt(sigma_s)
  std::vector<double> so_far_ = {0};  ///< integral of |amplitude|^2 over the sphere up to each node
};

}  // namespace flatspeckle::mc
