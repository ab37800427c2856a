#pragma once

#include "grin/space/part_medium.h"
#include "grin/surfaces/room.h"

namespace flatspeckle::grin {

/// What a leg of a flight is in: a medium, by equal steps.
struct LegRoom {
  Room room;
  const PartMedium& medium;
  double step;
};

enum class LegStop { collision, surface, lost };

}  // namespace flatspeckle::grin
