#pragma once

#include <numbers>
#include <optional>

#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class AreaDetectorEnd;

/// A detector on a rectangle of a face of a box boundary, or on the part of a sphere boundary in
/// front of a rectangle in the tangent plane. It measures the irradiance of light that arrives
/// within the angle `acceptance` of the outward normal, averaged over each pixel of the rectangle.
/// Column numbers increase along the cross product of outward normal and up, to the right as seen
/// along the arriving light.
struct AreaDetector {
  using End = AreaDetectorEnd;
  Vec3 centre, up;
  double width, height;
  PixelGrid pixels;
  double acceptance;  ///< half angle, rad, up to pi/2
};

extern const DatasetTable area_table;
inline const DatasetTable& table_of(const AreaDetector&) {
  return area_table;
}
PixelRectangle picture_of(const AreaDetector& detector);
NearestPlace nearest_place(const AreaDetector& detector, const Surface& boundary);

/// Path endpoint of an area detector, with W (path_end.h) = (du dv / dA) / pixel area. Here u and v
/// are coordinates on the rectangle, and du dv / dA is the cosine of the angle between the normals
/// at the point and at the centre, which is 1 on a box.
class AreaDetectorEnd {
 public:
  /// Throws InputError.
  AreaDetectorEnd(const AreaDetector& detector, const Stage& stage);

  const PixelGrid& pixels() const { return face_.grid(); }
  EndPosition sample_position(double stratum, RandomStream& random) const;
  /// Chooses a position for a connection from x, mostly where the straight line from x is accepted.
  EndPosition choose_position(const Vec3& x, RandomStream& random) const;
  double choice(const Vec3& position, const Vec3& x) const;
  EndDirection sample_direction(const EndPosition& at, double stratum, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  std::optional<EndPosition> position_at(const Vec3& x) const;

 private:
  double sensitivity(const EndPosition& at) const { return at.position_density * pixels().count(); }
  EndPosition on_face(const Vec3& x, int pixel) const;
  EndPosition at(double u, double v, int pixel) const;
  Window accepting_from(const Vec3& x) const;
  double choice_of(double u, double v, const Window& accepting) const;
  Vec3 inward(const Vec3& x) const;

  PixelRectangle face_;
  Surface boundary_;
  Vec3 centre_;
  Orientation view_;  ///< forward is the outward normal at the centre
  Acceptance acceptance_;
  Regions regions_;
};

struct AreaValues {
  using Sensor = AreaDetector;
  static constexpr const char* word = "area";
  std::vector<double> sensor_at{}, sensor_size{};
  std::vector<double> acceptance{std::numbers::pi / 2};
};

void add_keys(Keys& keys, AreaValues& values);
AreaDetector make_sensor(const OneSensor& of, const AreaValues& values, const Picture& picture);

}  // namespace flatspeckle::grin
