#pragma once

#include <cmath>
#include <vector>

#include "core/random.h"
#include "flatland/scene.h"
#include "grin/free_flight.h"
#include "mc/scattering.h"

namespace flatspeckle::mc {

/// Which of the request's lights paths are started for: so many that every light has one whose
/// attenuation and phase function are close to its own. The rest need no density of their own.
std::vector<double> representative_lights(const Scene& scene);

/// Samples a path's first scatterer and first direction by the attenuation and phase function of
/// the representative lights, all having equal shares, and knows the density of the mixture.
class FirstScatterer {
 public:
  explicit FirstScatterer(const Scene& scene) : domain_(scene.domain), mu_t_(scene.medium.mu_t) {
    for (double angle : representative_lights(scene)) lights_.push_back(direction(angle));
  }

  struct Sample {
    Vec2 x, arrival;
  };
  /// Uniform across a light's aperture, attenuated along the ray, never outside.
  Sample sample(RandomStream& random) const {
    const auto count = static_cast<double>(lights_.size());
    const Vec2 w = lights_[static_cast<std::size_t>(random.uniform() * count)];
    const Vec2 entry = sample_entry(w, random);
    const grin::BoundedFlight flight{mu_t_, domain_.distance_to_edge(entry, w)};
    return {entry + flight.sample(random.uniform()) * w, w};
  }

  /// Of the first scatterer alone, per area (per depth of a slab).
  double density(Vec2 x) const {
    double sum = 0;
    for (Vec2 w : lights_) sum += density(x, w);
    return sum / static_cast<double>(lights_.size());
  }

  /// Of the first scatterer and the direction in which it is left.
  template <typename Scattering>
  double density(Vec2 x, Vec2 start, const Scattering& scattering) const {
    double sum = 0;
    for (Vec2 w : lights_) sum += density(x, w) * scattering.density(w, start);
    return sum / static_cast<double>(lights_.size());
  }

 private:
  double density(Vec2 x, Vec2 w) const {
    const double behind = domain_.distance_to_edge(x, -w);
    const double chord = behind + domain_.distance_to_edge(x, w);
    return grin::BoundedFlight{mu_t_, chord}.density(behind) / aperture(w);
  }

  /// Length across which the light meets the medium; per unit length of a slab.
  double aperture(Vec2 w) const {
    if (domain_.kind == Domain::Kind::slab) return std::abs(w.z);
    return domain_.width * std::abs(w.z) + domain_.depth * std::abs(w.x);
  }

  Vec2 sample_entry(Vec2 w, RandomStream& random) const {
    const double far_z = w.z > 0 ? 0 : domain_.depth;
    if (domain_.kind == Domain::Kind::slab) return {0, far_z};
    const double across = random.uniform() * aperture(w);
    const double through_face = domain_.width * std::abs(w.z);
    if (across < through_face) return {across / std::abs(w.z) - domain_.width / 2, far_z};
    const double side = w.x > 0 ? -domain_.width / 2 : domain_.width / 2;
    return {side, (across - through_face) / std::abs(w.x)};
  }

  Domain domain_;
  double mu_t_;
  std::vector<Vec2> lights_;
};

}  // namespace flatspeckle::mc
