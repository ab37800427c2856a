#pragma once

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Two perpendicular unit vectors, the columns, both perpendicular to a ray; (column 0, column 1,
/// ray) is right-handed.
using Frame = Eigen::Matrix<double, 3, 2>;

/// Returns a frame perpendicular to v, which may have any length except 0. Its rotation about v is
/// arbitrary.
Frame frame_across(const Vec3& v);
/// Returns the frame transported to a ray that now points along v, rotated as little as possible.
Frame carried_across(const Frame& frame, const Vec3& v);

}  // namespace flatspeckle::grin
