#include "apps/sensor_options.h"

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <Eigen/Geometry>

#include "apps/key_values.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

using grin::Vec3;

constexpr double right_angle = std::numbers::pi / 2;

const std::map<std::string, std::set<std::string>> keys_of_sensor = {
    {"camera", {"sensor_at", "sensor_direction", "field_of_view", "lens_radius", "focus_distance"}},
    {"area", {"sensor_at", "sensor_size", "acceptance"}},
    {"directional", {"sensor_direction", "half_angle"}}};

void check_keys(const Subcommand& command, const SensorSpec& spec) {
  if (!keys_of_sensor.contains(spec.kind))
    throw InputError("sensor", spec.kind, "must be one of area camera directional");
  for (const auto& [kind, keys] : keys_of_sensor)
    for (const auto& key : keys)
      if (command.given(key) && !keys_of_sensor.at(spec.kind).contains(key))
        throw InputError(key + ": the sensor (" + spec.kind + ") has no use for it");
}

double angle_of(const std::string& key, double value, double most, const std::string& limit) {
  if (!(value > 0 && value <= most))
    throw InputError(key, value, "must be an angle in (0, " + limit + "], radians");
  return value;
}

grin::PixelGrid pixels_of(const SensorSpec& spec) {
  constexpr std::int64_t most = 16384;
  const auto& pixels = spec.pixels;
  const auto text = [&] {
    std::string words;
    for (const auto number : pixels) words += (words.empty() ? "" : " ") + std::to_string(number);
    return words;
  };
  if (pixels.size() != 2) throw InputError("pixels", text(), "must be two numbers: columns rows");
  for (const auto number : pixels)
    if (number < 1 || number > most)
      throw InputError("pixels", text(), "must be from 1 to " + std::to_string(most));
  return {static_cast<int>(pixels[0]), static_cast<int>(pixels[1])};
}

Vec3 position_of(const SensorSpec& spec) {
  if (spec.at.empty()) throw InputError("sensor_at is not given: x y z of the sensor");
  return vector_of("sensor_at", spec.at);
}

/// Two directions at right angles.
struct View {
  Vec3 forward, up;
};

View view_of(const SensorSpec& spec) {
  const Vec3 forward = direction_of("sensor_direction", spec.direction);
  const Vec3 given = direction_of("sensor_up", spec.up);
  const Vec3 up = given - forward * forward.dot(given);
  if (!(up.norm() > 1e-6))
    throw InputError("sensor_up", listed(spec.up), "must not be along sensor_direction");
  return {forward, up.normalized()};
}

grin::Camera camera(const Subcommand& command, const SensorSpec& spec) {
  if (!spec.field_of_view)
    throw InputError("field_of_view is not given: full angle of the camera's rows, radians");
  const double angle = *spec.field_of_view;
  if (!(angle > 0 && angle < std::numbers::pi))
    throw InputError("field_of_view", angle, "must be an angle in (0, pi), radians");
  const auto [forward, up] = view_of(spec);
  grin::Camera camera{position_of(spec), forward, up, angle, pixels_of(spec)};
  if (!spec.lens_radius) {
    if (command.given("focus_distance"))
      throw InputError("focus_distance: a camera without lens_radius has no use for it");
    return camera;
  }
  camera.lens_radius = positive("lens_radius", *spec.lens_radius);
  if (!spec.focus_distance) throw InputError("focus_distance is not given: a lens needs it");
  camera.focus_distance = positive("focus_distance", *spec.focus_distance);
  return camera;
}

grin::AreaDetector area(const SensorSpec& spec) {
  if (spec.size.empty()) throw InputError("sensor_size is not given: width height of the area");
  if (spec.size.size() != 2)
    throw InputError("sensor_size", listed(spec.size), "must be two numbers: width height");
  for (double side : spec.size) positive("sensor_size", side);
  return {position_of(spec),
          direction_of("sensor_up", spec.up),
          spec.size[0],
          spec.size[1],
          pixels_of(spec),
          angle_of("acceptance", spec.acceptance.value_or(right_angle), right_angle, "pi/2")};
}

grin::DirectionalDetector directional(const SensorSpec& spec) {
  const auto [forward, up] = view_of(spec);
  return {forward, up,
          angle_of("half_angle", spec.half_angle.value_or(right_angle), right_angle, "pi/2"),
          pixels_of(spec)};
}

}  // namespace

void add_sensor_options(Options& options, SensorSpec& spec) {
  options.add("--sensor", spec.kind,
              "camera (default; reads L/n^2), area (irradiance on the boundary) or directional "
              "(power per solid angle that leaves the stage)");
  options.add("--sensor_at", spec.at, "x y z of the camera's eye or lens, or the area's middle");
  options.add("--sensor_direction", spec.direction,
              "Where the camera looks; middle of the directions of directional (default 0 0 1)");
  options.add("--sensor_up", spec.up, "Upwards in the picture (default 0 1 0)");
  options.add("--pixels", spec.pixels, "Columns and rows (default 64 64)");
  options.add("--field_of_view", spec.field_of_view, "camera: full angle of a row, radians");
  options.add("--lens_radius", spec.lens_radius,
              "camera: of a thin lens on the stage's boundary (default: pinhole)");
  options.add("--focus_distance", spec.focus_distance, "camera: of the lens");
  options.add("--sensor_size", spec.size, "area: width and height");
  options.add("--acceptance", spec.acceptance,
              "area: half angle about the normal, radians (default pi/2)");
  options.add("--half_angle", spec.half_angle,
              "directional: angle of the middle of a side, radians (default pi/2)");
}

grin::Sensor make_sensor(const Subcommand& command, const SensorSpec& spec) {
  check_keys(command, spec);
  if (spec.kind == "camera") return camera(command, spec);
  if (spec.kind == "area") return area(spec);
  return directional(spec);
}

}  // namespace flatspeckle::apps
