#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/phasor.h"
#include "core/random.h"
#include "flatland/scene.h"
#include "grin/free_flight.h"
#include "mc/scattering.h"

namespace flatspeckle::mc {

/// exp of it is 0, and finite arguments keep the vectorised exp honest.
inline constexpr double log_of_nothing = -1e4;

/// The plane waves that enter the medium: end factors e_i (C13) and the sampling of a path's first
/// scatterer by their attenuation, all lights having equal shares.
class Lights {
 public:
  explicit Lights(const Scene& scene)
      : domain_(scene.domain), k_(scene.k), mu_t_(scene.medium.mu_t) {
    for (double angle : scene.request.lights) direction_.emplace_back(angle);
    phase_.resize(size());
    log_magnitude_.resize(size());
  }

  std::size_t size() const { return direction_.size(); }
  const Direction& direction(std::size_t light) const { return direction_[light]; }

  /// Length across which the light meets the medium; per unit length of a slab.
  double aperture(std::size_t light) const {
    const Vec2 w = direction_[light].w;
    if (domain_.kind == Domain::Kind::slab) return std::abs(w.z);
    return domain_.width * std::abs(w.z) + domain_.depth * std::abs(w.x);
  }

  /// A first scatterer: uniform across the aperture, attenuated along the ray, never outside.
  Vec2 sample_first(std::size_t light, RandomStream& random) const {
    const Vec2 entry = sample_entry(light, random);
    const Vec2 w = direction_[light].w;
    const grin::BoundedFlight flight{mu_t_, domain_.distance_to_edge(entry, w)};
    return entry + flight.sample(random.uniform()) * w;
  }

  /// e_i(x) of every light, and the density with which sample_first of it comes to x.
  void at(Vec2 x, std::span<Complex> factor, std::span<double> density) {
    for (std::size_t i = 0; i < size(); ++i) {
      const Vec2 w = direction_[i].w;
      const double behind = domain_.distance_to_edge(x, -w);
      const double chord = behind + domain_.distance_to_edge(x, w);
      phase_[i] = k_ * dot(w, x);
      log_magnitude_[i] = std::max(-mu_t_ * behind / 2, log_of_nothing);
      density[i] = grin::BoundedFlight{mu_t_, chord}.density(behind) / aperture(i);
    }
    damped_phasors(phase_, log_magnitude_, factor);
  }

 private:
  Vec2 sample_entry(std::size_t light, RandomStream& random) const {
    const Vec2 w = direction_[light].w;
    const double far_z = w.z > 0 ? 0 : domain_.depth;
    if (domain_.kind == Domain::Kind::slab) return {0, far_z};
    const double across = random.uniform() * aperture(light);
    const double through_face = domain_.width * std::abs(w.z);
    if (across < through_face) return {across / std::abs(w.z) - domain_.width / 2, far_z};
    const double side = w.x > 0 ? -domain_.width / 2 : domain_.width / 2;
    return {side, (across - through_face) / std::abs(w.x)};
  }

  Domain domain_;
  double k_, mu_t_;
  std::vector<Direction> direction_;
  std::vector<double> phase_, log_magnitude_;
};

}  // namespace flatspeckle::mc
