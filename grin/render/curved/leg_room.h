#pragma once

#include <limits>

#include "grin/rays/surfaces/room.h"
#include "grin/render/stage/part_medium.h"

namespace flatspeckle::grin {

/// What a leg of a flight is in: a medium, by equal steps.
struct LegRoom {
  Room room;
  const PartMedium& medium;
  double step;
};

enum class LegStop {
  collision,
  surface,
  lost,
  steps  ///< so many were made
};

/// How far a leg has come.
struct LegProgress {
  double collision;   ///< arc length of the next, tentative
  double weight = 1;  ///< of light that is absorbed and not scattered: what is left
};

/// Arc length from one tentative collision to the next.
inline double next_collision(const PartMedium& medium, double after, RandomStream& random) {
  if (!medium.scatters() && !medium.grid()) return std::numeric_limits<double>::infinity();
  return after + sample_free_flight(medium.majorant(), random.uniform());
}

}  // namespace flatspeckle::grin
