#pragma once

#include "grin/space/part_medium.h"
#include "grin/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// What a leg of a flight is in: a medium inside a surface, by equal steps.
struct LegRoom {
  const Surface& surface;
  const PartMedium& medium;
  double step;
};

enum class LegStop { collision, surface, lost };

}  // namespace flatspeckle::grin
