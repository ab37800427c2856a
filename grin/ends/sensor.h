#pragma once

#include <variant>

#include "grin/ends/area_detector.h"
#include "grin/ends/camera.h"
#include "grin/ends/directional_detector.h"

namespace flatspeckle::grin {

using Sensor = std::variant<Camera, AreaDetector, DirectionalDetector>;

/// What the file of a sensor has.
const DatasetTable& table_of(const Sensor& sensor);
/// Its pixels. Throws InputError for sizes that are not positive.
PixelRectangle picture_of(const Sensor& sensor);

/// The sensor of a scene as an end of paths; same interface as Lights.
///
/// `stratum`, the same number in (0, 1) for the position and the direction, picks the pixel: evenly
/// spread numbers share the paths of a batch evenly among the pixels. Densities are those of a
/// uniform stratum.
class SensorEnd {
 public:
  /// Throws InputError naming the key (sensor_at, sensor_direction, sensor_up, field_of_view,
  /// pixels, lens_radius, focus_distance, sensor_size, acceptance, half_angle) for a sensor outside
  /// the stage or inside the body, and for sizes that are not positive.
  SensorEnd(const Sensor& sensor, const Stage& stage);

  PixelGrid pixels() const {
    return std::visit([](const auto& end) { return end.pixels(); }, end_);
  }

  template <class S>
  EndPosition sample_position(const S& space, RandomStream& random, double stratum) const {
    EndPosition at =
        std::visit([&](const auto& end) { return end.sample_position(stratum, random); }, end_);
    at.index = space.index(at.point);
    return at;
  }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random, double stratum) const;
  template <class S>
  EndPosition sample_position(const S& space, RandomStream& random) const {
    return sample_position(space, random, random.uniform());
  }
  /// For a join from x: where the sensor may see light from there.
  template <class S>
  EndPosition choose_position(const S& space, const Vec3& x, RandomStream& random) const {
    const auto* area = std::get_if<AreaDetectorEnd>(&end_);
    if (!area) return sample_position(space, random);
    EndPosition at = area->choose_position(x, random);
    at.index = space.index(at.point);
    return at;
  }
  /// Density of choosing this place from x over at.position_density.
  double choice(const EndPosition& at, const Vec3& x) const {
    const auto* area = std::get_if<AreaDetectorEnd>(&end_);
    return area ? area->choice(at.point.x, x) : 1;
  }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const {
    return sample_direction(at, random, random.uniform());
  }
  /// pixel -1 and strength 0 where the sensor does not look.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

  /// A pinhole cannot.
  bool can_be_hit() const;
  /// A path arrives on the boundary at x along `direction`: calls use(EndHit) if the sensor sees
  /// it.
  template <class S, class Use>
  void hit(const S& space, const Vec3& x, const Vec3& direction, const Use& use) const {
    auto at = std::visit([&](const auto& end) { return end.position_at(x); }, end_);
    if (!at) return;
    at->index = space.index(at->point);
    use_hit(*at, towards(*at, -direction), use);
  }

 private:
  using End = std::variant<CameraEnd, AreaDetectorEnd, DirectionalEnd>;
  End end_;
};

}  // namespace flatspeckle::grin
