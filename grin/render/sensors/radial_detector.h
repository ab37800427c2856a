#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/sensors/pixel_rings.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class RadialDetectorEnd;

/// A disk on a face of a box boundary, or the cap of a sphere's within this distance of its middle:
/// irradiance averaged over rings of distance, of light that arrives within `acceptance` of the
/// outward normal. One ring is the end of a fibre.
struct RadialDetector {
  using End = RadialDetectorEnd;
  Vec3 centre;
  double radius;
  int rings;
  double acceptance;  ///< half angle, rad, up to pi/2
  /// Where given, rings from each to the next, and the powers within each: the last is `radius`.
  std::vector<double> radii = {};
};

extern const DatasetTable radial_table;
inline const DatasetTable& table_of(const RadialDetector&) {
  return radial_table;
}
PixelRings picture_of(const RadialDetector& detector);
NearestPlace nearest_place(const RadialDetector& detector, const Surface& boundary);

/// W = 1 / ring's area.
class RadialDetectorEnd {
 public:
  /// Throws InputError.
  RadialDetectorEnd(const RadialDetector& detector, const Stage& stage);

  PixelGrid pixels() const { return rings_.grid(); }
  EndPosition sample_position(double stratum, RandomStream& random) const;
  EndDirection sample_direction(const EndPosition& at, double, RandomStream& random) const {
    return acceptance_.sample(at, 1 / rings_.area(at.pixel), random);
  }
  EndDirection towards(const EndPosition& at, const Vec3& direction) const {
    return acceptance_.towards(at, direction, 1 / rings_.area(at.pixel));
  }
  std::optional<EndPosition> position_at(const Vec3& x) const;

 private:
  EndPosition on_ring(const BoundaryPoint& at, int ring) const;

  PixelRings rings_;
  BoundaryPatch patch_;
  Vec3 centre_;
  Acceptance acceptance_;
  Regions regions_;
};

struct RadialValues {
  using Sensor = RadialDetector;
  static constexpr const char* word = "radial";
  std::vector<double> sensor_at{}, sensor_radius{}, radii{};
  std::vector<std::int64_t> rings{};
  std::vector<double> acceptance{std::numbers::pi / 2};
};

void add_keys(Keys& keys, RadialValues& values);
RadialDetector make_sensor(const OneSensor& of, const RadialValues& values);

}  // namespace flatspeckle::grin
