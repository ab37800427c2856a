#pragma once

#include <numbers>

#include "grin/render/sensors/pixel_rings.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class PolarDetectorEnd;

/// A detector of all light that leaves the stage through its boundary, by polar angle from `axis`.
/// It measures power per solid angle, averaged over rings of equal width in that angle.
struct PolarDetector {
  using End = PolarDetectorEnd;
  Vec3 axis;
  double half_angle;  ///< largest polar angle of the rings, rad, up to pi
  int rings;
};

extern const DatasetTable polar_table;
inline const DatasetTable& table_of(const PolarDetector&) {
  return polar_table;
}
PixelRings picture_of(const PolarDetector& detector);
inline NearestPlace nearest_place(const PolarDetector& detector, const Surface& boundary) {
  return in_front(detector.axis, boundary);
}

/// Path endpoint of a polar detector, with W (path_end.h) = 1 / (solid angle of the ring).
class PolarDetectorEnd : public WholeBoundary {
 public:
  /// Throws InputError.
  PolarDetectorEnd(const PolarDetector& detector, const Stage& stage);

  PixelGrid pixels() const { return rings_.grid(); }
  EndDirection sample_direction(const EndPosition& at, double stratum, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

 private:
  EndDirection along(const EndPosition& at, const Vec3& direction, int ring) const;

  Vec3 axis_;
  PixelRings rings_;
};

struct PolarValues {
  using Sensor = PolarDetector;
  static constexpr const char* word = "polar";
  std::vector<double> sensor_direction{0, 0, 1};
  std::vector<double> largest_angle{std::numbers::pi / 2};
  std::vector<std::int64_t> rings{};
};

void add_keys(Keys& keys, PolarValues& values);
PolarDetector make_sensor(const OneSensor& of, const PolarValues& values);

}  // namespace flatspeckle::grin
