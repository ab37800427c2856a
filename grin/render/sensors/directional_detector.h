#pragma once

#include <numbers>

#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class DirectionalEnd;

/// All light that leaves the stage through its boundary, by direction: power per solid angle in
/// pixels of the sines of the angles from `forward` (orthographic), averaged over each pixel:
/// column along forward x up.
struct DirectionalDetector {
  using End = DirectionalEnd;
  Vec3 forward, up;
  double half_angle;  ///< of the square's half side, its sine; up to pi/2
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

/// With u, v the components of the outward direction, du dv = cos(theta) dw, theta from forward:
/// W = cos(theta) / pixel area. Pixels beyond the horizon, in the corners, stay dark.
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
