#pragma once

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// How scatterers move in a time that the delays count: they diffuse, k^2 D per unit of delay, and
/// flow along. Materials of a medium that varies may have their own share of both.
struct Motion {
  double diffusion = 1;
  Vec2 velocity{};   ///< length per unit of delay
  double shear = 0;  ///< of the velocity along x, per depth

  /// Diffusion alone, 1 everywhere: delays are k^2 D tau.
  bool only_diffuses(const Scene& scene) const {
    return diffusion == 1 && velocity == Vec2{} && shear == 0 && !scene.profile;
  }
};

/// That of a scene at a place.
class LocalMotion {
 public:
  LocalMotion(const Scene& scene, const Motion& motion)
      : motion_(motion), profile_(scene.profile.get()) {}

  double diffusion(Vec2 x) const { return motion_.diffusion * material(x).diffusion; }
  Vec2 velocity(Vec2 x) const {
    const double share = material(x).velocity;
    return {share * (motion_.velocity.x + motion_.shear * x.z), share * motion_.velocity.z};
  }

 private:
  MaterialMotion material(Vec2 x) const {
    return profile_ != nullptr ? profile_->materials()[profile_->material_at(x)].motion
                               : MaterialMotion{};
  }

  Motion motion_;
  const MediumProfile* profile_;
};

}  // namespace flatspeckle::mc
