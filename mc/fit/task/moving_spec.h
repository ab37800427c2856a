#pragma once

#include "flatland/scene/scene.h"
#include "mc/jobs/motion.h"

namespace flatspeckle::mc {

/// A scene and how its scatterers move while it is measured.
struct MovingSpec : SceneSpec {
  double diffusion = 1, velocity_x = 0, velocity_z = 0, shear = 0, beta = 1;

  Motion motion() const { return {diffusion, {velocity_x, velocity_z}, shear}; }
  /// Diffusion alone, which transport can do.
  bool only_diffuses() const { return velocity_x == 0 && velocity_z == 0 && shear == 0; }
};

/// Of the motion alone.
void add_motion_keys(Keys& keys, MovingSpec& spec);
/// All, found by the struct's name (Keyed).
void add_keys(Keys& keys, MovingSpec& spec);

}  // namespace flatspeckle::mc
