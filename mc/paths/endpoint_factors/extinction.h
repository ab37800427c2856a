#pragma once

#include "flatland/scene/scene.h"
#include "grin/media/scattering/free_flight.h"
#include "mc/paths/endpoint_factors/profile_flight.h"

namespace flatspeckle::mc {

/// What a scene's medium takes from light on its way: mu_t, or where it varies its profile.
struct Extinction {
  double mu_t;
  const MediumProfile* profile = nullptr;  ///< null where mu_t is the same everywhere

  explicit Extinction(const Scene& scene) : mu_t(scene.medium.mu_t), profile(scene.profile.get()) {}

  double optical_depth(Vec2 x, Vec2 w, double length) const {
    return profile != nullptr ? profile->optical_depth(x, w, length) : mu_t * length;
  }
  /// A flight that is no longer than `longest`, and the density of such.
  double sample_flight(Vec2 x, Vec2 w, double longest, double u) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).sample(u);
    return grin::BoundedFlight{mu_t, longest}.sample(u);
  }
  double flight_density(Vec2 x, Vec2 w, double longest, double distance) const {
    if (profile != nullptr) return ProfileFlight(*profile, x, w, longest).density(distance);
    return grin::BoundedFlight{mu_t, longest}.density(distance);
  }
};

}  // namespace flatspeckle::mc
