#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "grin/render/sensors/area_detector.h"
#include "grin/render/sensors/camera.h"
#include "grin/render/sensors/directional_detector.h"
#include "grin/render/sensors/polar_detector.h"
#include "grin/render/sensors/radial_detector.h"

namespace flatspeckle::grin {

/// All kinds of sensors (sensor_kind.h); the one list of them.
using SensorKinds =
    std::tuple<CameraValues, AreaValues, RadialValues, DirectionalValues, PolarValues>;

template <class Kinds>
struct SensorsOf;
template <class... Kind>
struct SensorsOf<std::tuple<Kind...>> {
  using Sensor = std::variant<typename Kind::Sensor...>;
  using End = std::variant<typename Kind::Sensor::End...>;
};
using Sensor = SensorsOf<SensorKinds>::Sensor;

/// The sensors of a scene as keys have them: the words of their kinds, and what each kind needs.
struct SensorValues {
  std::vector<std::string> sensor{CameraValues::word};
  std::vector<std::string> sensor_name{};  ///< none: "1", "2", ...
  std::vector<double> sensor_up{0, 1, 0};
  std::vector<std::int64_t> pixels{64, 64};
  SensorKinds kinds{};

  template <class Kind>
  Kind& of() {
    return std::get<Kind>(kinds);
  }
};

void add_keys(Keys& keys, SensorValues& values);
/// Both throw InputError.
std::vector<Sensor> make_sensors(const Keys& keys, const SensorValues& values);
std::vector<std::string> make_sensor_names(const Keys& keys, const SensorValues& values);

/// What the file of a sensor has.
const DatasetTable& table_of(const Sensor& sensor);
SensorPixels pixels_of(const Sensor& sensor);

/// A sensor of a scene as an end of paths; same interface as StageLights. Its pixels are numbered
/// from first_pixel on.
///
/// `stratum`, the same number in (0, 1) for the position and the direction, picks the pixel: evenly
/// spread numbers share the paths of a batch evenly among the pixels. Densities are those of a
/// uniform stratum.
class SensorEnd {
 public:
  /// Throws InputError naming the key for a sensor outside the stage, or one
  /// that does not fit on the boundary.
  SensorEnd(const Sensor& sensor, const Stage& stage, int first_pixel = 0);

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
    EndPosition at = std::visit(
        [&](const auto& end) {
          if constexpr (requires { end.choose_position(x, random); })
            return end.choose_position(x, random);
          else
            return end.sample_position(random.uniform(), random);
        },
        end_);
    at.index = space.index(at.point);
    return at;
  }
  /// Density of choosing this place from x over at.position_density.
  double choice(const EndPosition& at, const Vec3& x) const;
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const {
    return sample_direction(at, random, random.uniform());
  }
  /// pixel -1 and strength 0 where the sensor does not look.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

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
  EndDirection numbered(EndDirection to) const {
    if (to.pixel >= 0) to.pixel += first_pixel_;
    return to;
  }

  SensorsOf<SensorKinds>::End end_;
  int first_pixel_;
};

/// All sensors of a scene, their pixels numbered through. Throws as SensorEnd does.
std::vector<SensorEnd> sensor_ends(const std::vector<Sensor>& sensors, const Stage& stage);

}  // namespace flatspeckle::grin
