#pragma once

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Two unit vectors that span the plane across a ray; (column 0, column 1, ray) is right-handed.
using Frame = Eigen::Matrix<double, 3, 2>;

/// Some frame across v, a vector of any length but 0.
Frame frame_across(const Vec3& v);
/// The frame carried along to a ray that points along v now, turned as little as possible.
Frame carried_across(const Frame& frame, const Vec3& v);

}  // namespace flatspeckle::grin
