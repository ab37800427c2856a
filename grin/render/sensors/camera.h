#pragma once

#include <optional>

#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

class CameraEnd;

/// A camera with view direction `forward`. It measures L/n^2, averaged over each pixel of its film.
struct Camera {
  using End = CameraEnd;
  Vec3 x, forward, up;
  double field_of_view;  ///< full angle of view along a row of pixels, rad, < pi
  PixelGrid pixels;
  /// Radius of the lens; 0 for a pinhole. A lens is a part of the boundary (BoundaryPatch) that
  /// light can hit; L/n^2 is then also averaged over the lens.
  double lens_radius = 0;
  /// Distance to the plane of focus, along forward; larger than lens_radius.
  double focus_distance = 1;
};

extern const DatasetTable camera_table;
inline const DatasetTable& table_of(const Camera&) {
  return camera_table;
}
PixelRectangle picture_of(const Camera& camera);
inline NearestPlace nearest_place(const Camera& camera, const Surface&) {
  return [x = camera.x](const Vec3&) { return x; };
}

/// Path endpoint of a camera. The film is the plane of focus at distance F; its coordinates u and v
/// are tangents of angles seen from the camera's centre. A ray from x on the lens along d, at an
/// angle theta from forward, meets the plane at x + t d, where t = F' / cos(theta) and
/// F' = F - (x - centre).forward. It follows that
///   du dv / dw = t^2 / (F^2 cos(theta)) = (F'/F)^2 / cos^3(theta);
/// a pinhole has F' = F. Focusing assumes straight rays in the index at the lens; the index field
/// bends the rays beyond it.
class CameraEnd {
 public:
  /// Throws InputError.
  CameraEnd(const Camera& camera, const Stage& stage);

  const PixelGrid& pixels() const { return film_.grid(); }
  EndPosition sample_position(double stratum, RandomStream& random) const;
  EndDirection sample_direction(const EndPosition& at, double stratum, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  std::optional<EndPosition> position_at(const Vec3& x) const;
  /// Whether light can hit the camera: true for a lens, false for a pinhole.
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
