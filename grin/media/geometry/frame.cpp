#include "grin/media/geometry/frame.h"

#include <Eigen/Geometry>

namespace flatspeckle::grin {

Frame frame_across(const Vec3& v) {
  // Builds an orthonormal basis without branches [duff2017].
  const Vec3 w = v.normalized();
  const double sign = std::copysign(1.0, w.z());
  const double a = -1 / (sign + w.z());
  const double b = w.x() * w.y() * a;
  Frame frame;
  frame.col(0) << 1 + sign * w.x() * w.x() * a, sign * b, -sign * w.x();
  frame.col(1) << b, sign + w.y() * w.y() * a, -w.y();
  return frame;
}

Frame carried_across(const Frame& frame, const Vec3& v) {
  const Vec3 w = v.normalized();
  Frame carried;
  carried.col(0) = (frame.col(0) - w * w.dot(frame.col(0))).normalized();
  carried.col(1) = w.cross(carried.col(0));
  return carried;
}

}  // namespace flatspeckle::grin
