#pragma once

#include <numbers>

#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class DirectionalEnd;

/// A detector of all light that leaves the stage through its boundary, by direction. It measures
/// power per solid angle, averaged over each pixel. The coordinates of the picture are the
/// components of the direction across `forward` (orthographic projection). Column numbers increase
/// along the cross product of forward and up.
struct DirectionalDetector {
  using End = DirectionalEnd;
  Vec3 forward, up;
  double half_angle;  ///< rad, up to pi/2; its sine is half the side of the square picture
  PixelGrid pixels;
};

extern const DatasetTable directional_table;
inline const DatasetTable& table_of(const DirectionalDetector&) {
  return directional_table;
}
PixelRectangle picture_of(const DirectionalDetector& detector);
inline NearestPlace nearest_place(const DirectionalDetector& detector, const Surface& boundary) {
  return in_front(detector.forward, boundary);
}

/// Path endpoint of a directional detector. If u, v are the components of the outward direction
/// across forward and theta is its angle from forward, then du dv = cos(theta) dw per solid angle
/// dw, so that W (path_end.h) = cos(theta) / pixel area. Pixels in the corners, where u^2 + v^2 >
/// 1, stay dark.
class DirectionalEnd : public WholeBoundary {
 public:
  /// Throws InputError.
  DirectionalEnd(const DirectionalDetector& detector, const Stage& stage);

  const PixelGrid& pixels() const { return picture_.grid(); }
  EndDirection sample_direction(const EndPosition& at, double stratum, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

 private:
  EndDirection along(const EndPosition& at, const Vec3& direction, int pixel) const;

  Orientation view_;
  PixelRectangle picture_;
};

struct DirectionalValues {
  using Sensor = DirectionalDetector;
  static constexpr const char* word = "directional";
  std::vector<double> sensor_direction{0, 0, 1};
  std::vector<double> half_angle{std::numbers::pi / 2};
};

void add_keys(Keys& keys, DirectionalValues& values);
DirectionalDetector make_sensor(const OneSensor& of, const DirectionalValues& values,
                                const Picture& picture);

}  // namespace flatspeckle::grin
