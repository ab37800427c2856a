#pragma once

#include "core/keys/keys.h"
#include "grin/design/goal.h"
#include "grin/design/ray_system.h"

namespace flatspeckle::grin::design {

/// Rays, and what is asked of them.
struct DesignTask {
  std::unique_ptr<RaySystem> rays;
  std::unique_ptr<Goal> goal;
};

/// Parallel light onto a ball from directions all around it, and where it is to meet: a point on
/// the line through the centre along each direction.
struct FocusLight {
  Sphere ball;
  double focus;     ///< from the centre
  double aperture;  ///< of the ball's radius
  int directions, rays_each;

  /// turned: of rays that others have not seen.
  DesignTask task(const RayWalk& walk, bool turned) const;
};

}  // namespace flatspeckle::grin::design
