#pragma once

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Motion of the scatterers: diffusion with the diffusion constant D, and flow. Rates are per unit
/// of delay. In a varying medium each material may multiply the diffusion and the velocity by its
/// own factors (MaterialMotion).
struct Motion {
  double diffusion = 1;  ///< k^2 D per unit of delay
  Vec velocity{};        ///< length per unit of delay
  double shear = 0;      ///< shear rate: growth of velocity_x per unit of depth

  /// Whether the scatterers do not flow and diffuse alike everywhere.
  bool only_diffuses(const Scene& scene) const {
    return velocity == Vec{} && shear == 0 && !scene.profile;
  }
};

/// Motion of a scene's scatterers at a given position.
class LocalMotion {
 public:
  LocalMotion(const Scene& scene, const Motion& motion)
      : motion_(motion), profile_(scene.profile.get()) {}

  double diffusion(Vec x) const { return motion_.diffusion * material(x).diffusion; }
  Vec velocity(Vec x) const {
    const double share = material(x).velocity;
    return share * (motion_.velocity + Vec{motion_.shear * x.z});
  }

 private:
  MaterialMotion material(Vec x) const {
    return profile_ != nullptr ? profile_->materials()[profile_->material_at(x)].motion
                               : MaterialMotion{};
  }

  Motion motion_;
  const MediumProfile* profile_;
};

}  // namespace flatspeckle::mc
