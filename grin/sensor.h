#pragma once

#include <array>
#include <functional>
#include <optional>
#include <variant>

#include "grin/path_end.h"
#include "grin/stage.h"

namespace flatspeckle::grin {

/// Pixels, row 0 on top; pixel number = row columns + column.
struct PixelGrid {
  int columns = 1, rows = 1;
  int count() const { return columns * rows; }
};

/// A camera that looks along `forward`: L/n^2 averaged over each pixel of its film.
struct Camera {
  Vec3 x, forward, up;
  double field_of_view;  ///< across the columns, full angle, rad, < pi
  PixelGrid pixels;
  double lens_radius = 0;     ///< 0: pinhole. A lens lies on the boundary (its plane face, or flat
                              ///< to the order of radius^2) and can be hit
  double focus_distance = 1;  ///< of the lens
};

/// A rectangle on a face of a box boundary, or on the tangent plane of a sphere's: irradiance,
/// power per area of each pixel, of light that arrives within `acceptance` of the outward normal.
struct AreaDetector {
  Vec3 centre, up;
  double width, height;
  PixelGrid pixels;
  double acceptance;  ///< half angle, rad, up to pi/2
};

/// All light that leaves the stage through its boundary, by direction: power per solid angle in
/// pixels of the sines of the angles from `forward` (orthographic): column along forward x up.
struct DirectionalDetector {
  Vec3 forward, up;
  double half_angle;  ///< of the square's half side, its sine; up to pi/2
  PixelGrid pixels;
};

using Sensor = std::variant<Camera, AreaDetector, DirectionalDetector>;

/// The sensor of a scene as an end of paths; same interface as Lights.
class SensorEnd {
 public:
  using Index = std::function<double(const PathPoint&)>;

  /// Throws InputError for a sensor outside the stage or inside the body's wall, and for sizes that
  /// are not positive.
  SensorEnd(Sensor sensor, const Stage& stage, Index index);

  PixelGrid pixels() const;
  EndPosition sample_position(RandomStream& random) const;
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const;
  /// pixel -1 and strength 0 where the sensor does not look.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  template <class Use>
  void hit(const Vec3& x, const Vec3& direction, const Use& use) const;
};

}  // namespace flatspeckle::grin
