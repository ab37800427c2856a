#include "grin/render/sensors/sensor.h"

#include <algorithm>

#include "core/keys/kinds.h"

namespace flatspeckle::grin {

namespace {

constexpr const char* no_sensor = "none";

std::vector<std::string> words_for_sensors(const SensorKinds& kinds) {
  std::vector<std::string> words = kind_words(kinds);
  words.emplace_back(no_sensor);
  return words;
}

SensorPixels pixels_of(const PixelRectangle& pixels) {
  return {pixels.grid(),
          pixels.area(),
          {{"row", pixels.row_centres()}, {"column", pixels.column_centres()}}};
}

SensorPixels pixels_of(const PixelRings& rings) {
  return {rings.grid(), rings.area(), {{rings.axis(), rings.centres()}}, rings.shares()};
}

Picture make_picture(const OneSensor& of, const SensorValues& values) {
  const auto pixels = of.part(values.pixels, 2);
  return {of.vector(values.sensor_up), {static_cast<int>(pixels[0]), static_cast<int>(pixels[1])}};
}

}  // namespace

const DatasetTable& table_of(const Sensor& sensor) {
  return std::visit([](const auto& kind) -> const DatasetTable& { return table_of(kind); }, sensor);
}

SensorPixels pixels_of(const Sensor& sensor) {
  return std::visit([](const auto& kind) { return pixels_of(picture_of(kind)); }, sensor);
}

SensorEnd::SensorEnd(const Sensor& sensor, const Stage& stage, int first_pixel)
    : end_(std::visit([&]<class S>(const S& of)
                          -> SensorsOf<SensorKinds>::End { return typename S::End(of, stage); },
                      sensor)),
      first_pixel_(first_pixel) {}

std::vector<SensorEnd> sensor_endpoints(const std::vector<Sensor>& sensors, const Stage& stage) {
  std::vector<SensorEnd> ends;
  int pixels = 0;
  for (const Sensor& sensor : sensors) {
    ends.emplace_back(sensor, stage, pixels);
    pixels += ends.back().pixels().count();
  }
  return ends;
}

EndDirection SensorEnd::sample_direction(const EndPosition& at, RandomStream& random,
                                         double stratum) const {
  return numbered(
      std::visit([&](const auto& end) { return end.sample_direction(at, stratum, random); }, end_));
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
  return numbered(std::visit([&](const auto& end) { return end.towards(at, direction); }, end_));
}

void add_keys(Keys& keys, SensorValues& values) {
  keys.group("Sensor");
  keys.add(
          "sensor", values.sensor,
          "Measures L/n^2 (camera), irradiance on the boundary (area; radial: by rings of a disk), "
          "or power per solid angle that leaves the stage (directional; polar: by polar angle). "
          "Several may be given: each key of a sensor then has one value for all sensors, or one "
          "for each; none: only a map is computed")
      .one_of(words_for_sensors(values.kinds));
  keys.add("sensor_name", values.sensor_name,
           "Names of the sensors: results are in the groups sensors/NAME")
      .only_of("several sensors");
  add_vectors(keys, "sensor_up", values.sensor_up, "Upward direction in the picture");
  keys.add("pixels", values.pixels, "Numbers of columns and rows of the picture")
      .each_of(2, "columns rows")
      .from(1, 16384);
  each_kind(values.kinds, [&](auto& kind) {
    keys.group(std::string("Sensor: ") + kind.word, kind.word);
    add_keys(keys, kind);
  });
}

std::vector<Sensor> make_sensors(const Keys& keys, const SensorValues& values) {
  const auto& words = keys.required(values.sensor);
  std::vector<Sensor> sensors;
  if (words == std::vector<std::string>{no_sensor}) return sensors;
  for (const std::string& word : words) {
    if (word == no_sensor) throw InputError("sensor", word, "must be the only value");
    const OneSensor of(keys, sensors.size(), words.size());
    with_kind(values.kinds, word, [&](const auto& kind) {
      if constexpr (requires { make_sensor(of, kind); })
        sensors.emplace_back(make_sensor(of, kind));
      else
        sensors.emplace_back(make_sensor(of, kind, make_picture(of, values)));
    });
  }
  return sensors;
}

std::vector<std::string> make_sensor_names(const Keys& keys, const SensorValues& values) {
  std::vector<std::string> names;
  if (values.sensor.size() == 1) return names;
  const auto refuse = [](const std::string& name, const char* accepted) {
    throw InputError("sensor_name", name, accepted);
  };
  for (const std::string& name : keys.read(values.sensor_name)) {
    if (name.find_first_not_of(
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") != name.npos ||
        name.empty())
      refuse(name, "must consist of letters, digits, _ and -");
    if (std::find(names.begin(), names.end(), name) != names.end())
      refuse(name, "must not be repeated");
    names.push_back(name);
  }
  if (names.empty())
    for (std::size_t i = 1; i <= values.sensor.size(); ++i) names.push_back(std::to_string(i));
  if (names.size() != values.sensor.size())
    refuse(names.back(), "must have one name for each sensor");
  return names;
}

}  // namespace flatspeckle::grin
