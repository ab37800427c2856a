#include "mc/fit/task/moving_spec.h"

namespace flatspeckle::mc {

void add_motion_keys(Keys& keys, MovingSpec& spec) {
  keys.group("Motion");
  keys.add("diffusion", spec.diffusion, "k^2 D of the scatterers per unit of the delays")
      .not_negative();
  keys.add("velocity_x", spec.velocity_x,
           "Of the scatterers along the surface, per unit of the delays")
      .unit("length");
  keys.add("velocity_z", spec.velocity_z, "Of the scatterers along the depth").unit("length");
  keys.add("shear", spec.shear, "Of the velocity: velocity_x grows so much per depth");
  keys.add("beta", spec.beta, "K^2 of still scatterers").positive_to(1);
}

void add_keys(Keys& keys, MovingSpec& spec) {
  add_keys(keys, static_cast<SceneSpec&>(spec));
  add_dimension_key(keys, spec);
  add_motion_keys(keys, spec);
}

}  // namespace flatspeckle::mc
