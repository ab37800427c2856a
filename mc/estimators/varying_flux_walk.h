#pragma once

#include <cmath>
#include <span>

#include "core/run/interrupt.h"
#include "mc/ends/profile_flight.h"
#include "mc/ends/varying_scattering.h"
#include "mc/estimators/flux_walk.h"

namespace flatspeckle::mc {

/// Walks light through a medium that varies, as FluxWalk does through one that is the same
/// everywhere: from the first collision on, which is forced, to where it ends. Plain flights;
/// absorption by weight, with roulette.
class VaryingFluxWalk {
 public:
  VaryingFluxWalk(const Scene& scene, const VaryingScattering& scattering, const LightEntry& entry,
                  RandomStream& random, std::span<Complex> sums)
      : domain_(scene.domain),
        profile_(*scene.profile),
        scattering_(scattering),
        entry_(entry),
        random_(random),
        tally_(scene.domain, sums) {}

  /// u: uniform in (0, 1), picks the depth of the first collision.
  void walk(double u) {
    const Vec2 start = entry_.sample(random_);
    Vec2 w = entry_.light();
    const ProfileFlight first(profile_, start, w, domain_.distance_to_edge(start, w));
    double power = first.probability();
    if (power == 0) return;
    Vec2 x = start + first.sample(u) * w;
    while (collide(x, power)) {
      w = scattering_.at(x).sample(w, random_);
      const double edge = domain_.distance_to_edge(x, w),
                   flight = profile_.reach(x, w, -std::log(random_.uniform()), edge);
      x = x + flight * w;
      if (flight >= edge) return tally_.leave(x, w, power);
    }
  }

 private:
  /// False if nothing is left.
  bool collide(Vec2 x, double& power) {
    constexpr std::uint64_t between_looks = 4096;
    if (++collisions_ % between_looks == 0) stop_if_interrupted();
    const double albedo = profile_.albedo(x);
    tally_.absorb(power * (1 - albedo));
    power *= albedo;
    constexpr double little = 0.1;
    if (power >= little) return true;
    const bool survives = random_.uniform() * little < power;
    power = little;
    return survives;
  }

  Domain domain_;
  const MediumProfile& profile_;
  const VaryingScattering& scattering_;
  const LightEntry& entry_;
  RandomStream& random_;
  FluxTally tally_;
  std::uint64_t collisions_ = 0;
};

}  // namespace flatspeckle::mc
