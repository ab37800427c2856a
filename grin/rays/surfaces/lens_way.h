#pragma once

#include "grin/rays/surfaces/lens.h"

namespace flatspeckle::grin {

// straight_way.h, of lenses.

double way_out(const Lens& lens, const Vec3& x, const Vec3& d);
double way_in(const Lens& lens, const Vec3& x, const Vec3& d);

}  // namespace flatspeckle::grin
