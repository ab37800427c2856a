#pragma once

#include <memory>

#include "grin/design/goals/goal.h"
#include "grin/design/system/ray_system.h"

namespace flatspeckle::grin::design {

/// Rays, and what is asked of them.
struct DesignTask {
  std::unique_ptr<RaySystem> rays;
  std::unique_ptr<Goal> goal;
};

/// What light is to do.
class Aim {
 public:
  virtual ~Aim() = default;
  /// held_out: of rays that the search does not see.
  virtual DesignTask task(const RayWalk& walk, bool held_out) const = 0;
  virtual double rays() const = 0;  ///< that the search sees
  /// Two numbers are read off each ray, or one.
  virtual int readings() const { return 2; }
};

}  // namespace flatspeckle::grin::design
