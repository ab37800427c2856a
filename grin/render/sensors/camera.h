#pragma once

#include <optional>

#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class CameraEnd;

/// A camera that looks along `forward`: L/n^2 averaged over each pixel of its film.
struct Camera {
  using End = CameraEnd;
  Vec3 x, forward, up;
  double field_of_view;  ///< across the columns, full angle, rad, < pi
  PixelGrid pixels;
  double lens_radius = 0;     ///< 0: pinhole. A lens is a part of the boundary (BoundaryPatch), and
                              ///< can be hit; the average is over it, too
  double focus_distance = 1;  ///< of the lens, along forward, more than its radius
};

extern const DatasetTable camera_table;
inline const DatasetTable& table_of(const Camera&) {
  return camera_table;
}
PixelRectangle picture_of(const Camera& camera);
inline NearestPlace nearest_place(const Camera& camera, const Surface&) {
  return [x = camera.x](const Vec3&) { return x; };
}

/// The film is the plane of focus, seen from the camera's centre: u and v are tangents. A ray from
/// x on the lens along d meets the plane at x + t d, t = F' / cos(theta), F' = F - (x - centre).
/// forward, so that du dv / dw = t^2 / (F^2 cos(theta)) = (F'/F)^2 / cos^3(theta), theta from
/// forward; a pinhole is the limit F' = F. Straight rays: the lens is a picture of focus in the
/// index at it, and refraction further on is left to the field.
class CameraEnd {
 public:
  /// Throws InputError.
  CameraEnd(const Camera& camera, const Stage& stage);

  const PixelGrid& pixels() const { return film_.grid(); }
  EndPosition sample_position(double stratum, RandomStream& random) const;
  EndDirection sample_direction(const EndPosition& at, double stratum, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  std::optional<EndPosition> position_at(const Vec3& x) const;
  /// A pinhole cannot.
  bool can_be_hit() const { return lens_.has_value(); }

 private:
  void place_lens(const Camera& camera, const Stage& stage);
  EndDirection along(const EndPosition& at, const Vec3& direction, int pixel) const;
  EndPosition on_lens(const BoundaryPoint& at) const;

  Orientation view_;
  PixelRectangle film_;
  Vec3 centre_;
  double focus_distance_;
  std::optional<BoundaryPatch> lens_;
  Regions regions_;
};

struct CameraValues {
  using Sensor = Camera;
  static constexpr const char* word = "camera";
  std::vector<double> sensor_at{}, sensor_direction{0, 0, 1};
  std::vector<double> field_of_view{}, lens_radius{}, focus_distance{};
};

void add_keys(Keys& keys, CameraValues& values);
Camera make_sensor(const OneSensor& of, const CameraValues& values, const Picture& picture);

}  // namespace flatspeckle::grin
