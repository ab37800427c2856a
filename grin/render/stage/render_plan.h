#pragma once

#include <string>

namespace flatspeckle::grin {

/// What light transport in a scene has to do; stored with the result. Leaving out what a scene does
/// not need never changes a result beyond rounding.
struct RenderPlan {
  bool curved = true;    ///< the index changes from point to point, not only at surfaces of bodies
  bool scatters = true;  ///< some medium does
  bool absorbs = true;   ///< some medium does; all that scatters is lossless without
  bool gridded = true;   ///< some medium's density is a grid
  bool body = true;      ///< one or more in the stage
  bool timed = true;     ///< more than one bin of optical path
  bool deep = true;      ///< light is split on its way to sensors deep behind a medium

  bool operator==(const RenderPlan&) const = default;

  /// For people, and for the result file.
  std::string describe() const;
};

}  // namespace flatspeckle::grin
