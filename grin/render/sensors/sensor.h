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

/// All kinds of sensors (sensor_kind.h). They are listed only here.
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

/// Values of the keys of sensors: for each sensor the name of its kind, and the values of each
/// kind.
struct SensorValues {
  std::vector<std::string> sensor{CameraValues::word};
  std::vector<std::string> sensor_name{};  ///< empty: the names are "1", "2", ...
  std::vector<double> sensor_up{0, 1, 0};
  std::vector<std::int64_t> pixels{64, 64};
  SensorKinds kinds{};

  template <class Kind>
  Kind& of() {
    return std::get<Kind>(kinds);
  }
};

void add_keys(Keys& keys, SensorValues& values);
/// Make the sensors and their names. Both throw InputError.
std::vector<Sensor> make_sensors(const Keys& keys, const SensorValues& values);
std::vector<std::string> make_sensor_names(const Keys& keys, const SensorValues& values);

/// Datasets of a sensor in the result file.
const DatasetTable& table_of(const Sensor& sensor);
SensorPixels pixels_of(const Sensor& sensor);

/// A sensor of a scene as a path endpoint; it has the same interface as StageLights. Its pixels are
/// numbered from first_pixel.
///
/// `stratum` in (0, 1) selects the pixel, and must be the same number for position and direction.
/// Stratified numbers distribute the paths of a batch evenly over the pixels. Densities assume that
/// the stratum is uniformly distributed.
class SensorEnd {
 public:
  /// Throws InputError naming the key for a sensor outside the stage, or one that does not fit on
  /// the boundary.
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
  /// Chooses a position for a connection from x, preferably one that accepts light from x.
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
  /// Returns the density with which choose_position() chooses this position for x, divided by
  /// at.position_density.
  double choice(const EndPosition& at, const Vec3& x) const;
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const {
    return sample_direction(at, random, random.uniform());
  }
  /// Returns strength, density and pixel of a direction; outside the view of the sensor the pixel
  /// is -1 and the strength 0.
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;

  bool can_be_hit() const;
  /// Calls use(EndHit) if a path that arrives on the boundary at x along `direction` hits the
  /// sensor within its view.
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

/// Makes all sensors of a scene with consecutive pixel numbers. Throws as SensorEnd does.
std::vector<SensorEnd> sensor_endpoints(const std::vector<Sensor>& sensors, const Stage& stage);

}  // namespace flatspeckle::grin
