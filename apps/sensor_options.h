#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line.h"
#include "grin/ends/sensor.h"

namespace flatspeckle::apps {

/// The sensor as the user writes it.
struct SensorSpec {
  std::string kind = "camera";
  std::vector<double> at, direction = {0, 0, 1}, up = {0, 1, 0}, size;
  std::optional<double> field_of_view, lens_radius, focus_distance, acceptance, half_angle;
  std::vector<std::int64_t> pixels = {64, 64};
};

void add_sensor_options(Options& options, SensorSpec& spec);

/// Throws InputError, also for keys that the sensor has no use for.
grin::Sensor make_sensor(const Subcommand& command, const SensorSpec& spec);

}  // namespace flatspeckle::apps
