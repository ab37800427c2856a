#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/sensors/pixel_rings.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class RadialDetectorEnd;

/// A detector on a disk of a face of a box boundary, or on a cap of a sphere boundary, within
/// `radius` of `centre`. It measures the irradiance of light that arrives within the angle
/// `acceptance` of the outward normal, averaged over rings. A single ring models the end of a
/// fibre.
struct RadialDetector {
  using End = RadialDetectorEnd;
  Vec3 centre;
  double radius;
  int rings;
  double acceptance;  ///< half angle, rad, up to pi/2
  /// If given, the outer radii of the rings; the power within each of them is then a result as
  /// well. The last one equals `radius`.
  std::vector<double> radii = {};
};

extern const DatasetTable radial_table;
inline const DatasetTable& table_of(const RadialDetector&) {
  return radial_table;
}
PixelRings picture_of(const RadialDetector& detector);
NearestPlace nearest_place(const RadialDetector& detector, const Surface& boundary);

/// Path endpoint of a radial detector, with W (path_end.h) = 1 / (area of the ring).
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
