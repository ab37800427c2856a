#include "grin/ends/sensor.h"

#include "core/keys/kinds.h"

namespace flatspeckle::grin {

const DatasetTable& table_of(const Sensor& sensor) {
  return std::visit([](const auto& kind) -> const DatasetTable& { return table_of(kind); }, sensor);
}

PixelRectangle picture_of(const Sensor& sensor) {
  return std::visit([](const auto& kind) { return picture_of(kind); }, sensor);
}

SensorEnd::SensorEnd(const Sensor& sensor, const Stage& stage)
    : end_(std::visit([&]<class S>(const S& of)
                          -> SensorsOf<SensorKinds>::End { return typename S::End(of, stage); },
                      sensor)) {}

EndDirection SensorEnd::sample_direction(const EndPosition& at, RandomStream& random,
                                         double stratum) const {
  return std::visit([&](const auto& end) { return end.sample_direction(at, stratum, random); },
                    end_);
}

double SensorEnd::choice(const EndPosition& at, const Vec3& x) const {
  return std::visit(
      [&](const auto& end) -> double {
        if constexpr (requires { end.choice(at.point.x, x); })
          return end.choice(at.point.x, x);
        else
          return 1;
      },
      end_);
}

bool SensorEnd::can_be_hit() const {
  return std::visit(
      [](const auto& end) -> bool {
        if constexpr (requires { end.can_be_hit(); })
          return end.can_be_hit();
        else
          return true;
      },
      end_);
}

EndDirection SensorEnd::towards(const EndPosition& at, const Vec3& direction) const {
  return std::visit([&](const auto& end) { return end.towards(at, direction); }, end_);
}

void add_keys(Keys& keys, SensorValues& values) {
  keys.group("Sensor");
  keys.add("sensor", values.sensor,
           "Reads L/n^2 (camera), irradiance on the boundary (area), or power per solid angle that "
           "leaves the stage (directional)")
      .one_of(kind_words(values.kinds));
  add_vector(keys, "sensor_up", values.sensor_up, "Upwards in the picture");
  keys.add("pixels", values.pixels, "Columns and rows")
      .exactly(2, "two numbers: columns rows")
      .from(1, 16384);
  each_kind(values.kinds, [&](auto& kind) {
    keys.group(std::string("Sensor: ") + kind.word, kind.word);
    add_keys(keys, kind);
  });
}

Sensor make_sensor(const Keys& keys, const SensorValues& values) {
  const auto& pixels = keys.read(values.pixels);
  const Picture picture{vector_of(keys.read(values.sensor_up)),
                        {static_cast<int>(pixels[0]), static_cast<int>(pixels[1])}};
  Sensor sensor;
  const auto make = [&](const auto& kind) {
    if (keys.read(values.sensor) == kind.word) sensor = make_sensor(keys, kind, picture);
  };
  std::apply([&](const auto&... kind) { (make(kind), ...); }, values.kinds);
  return sensor;
}

}  // namespace flatspeckle::grin
