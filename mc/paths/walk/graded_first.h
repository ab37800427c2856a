#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/numbers/random.h"
#include "mc/paths/bent/graded_scattering.h"
#include "mc/paths/walk/first_scatterer.h"

namespace flatspeckle::mc {

/// First scatterers of a path where light is bent (as first_scatterer.h): a ray of one of the
/// representative lights, uniform over those that meet the domain, attenuated along it in sigma.
class GradedFirst {
 public:
  GradedFirst(const Scene& scene, const GradedScattering& scattering);

  struct Sample {
    Vec2 x, arrival;
    bool hit = true;  ///< else the ray misses the domain, and the path has no scatterer
  };
  Sample sample(RandomStream& random) const;

  double density(Vec2 x) const;
  double density(Vec2 x, Vec2 start, const GradedScattering& scattering) const;

 private:
  struct Rays {
    std::shared_ptr<const Wavefront> wave;
    Light light;
    double low, high;   ///< of the launch of rays that meet the domain
    double per_launch;  ///< of a unit wave, power per launch: |cos| of a plane wave, else 1
  };
  Rays rays_of(const Light& light) const;
  RayPlace launched(const Rays& rays, double launch) const;
  double density(const Rays& rays, const Arrival& arrival, Vec2 x) const;

  Domain domain_;
  double mu_t_;
  const GradedMedium& medium_;
  std::vector<Rays> lights_;
  std::optional<FirstScatterer> straight_;  ///< where refraction is in the end factors alone
};

}  // namespace flatspeckle::mc
