#pragma once

#include <optional>
#include <vector>

#include "core/result/dataset_row.h"
#include "grin/ends/sensor.h"

namespace flatspeckle::grin {

extern const DatasetTable camera_table, area_table, directional_table;

/// What a sensor's file has: the table of its kind.
const DatasetTable& table_of(const Sensor& sensor);

/// Centres of the pixels along rows and columns.
struct SensorAxes {
  std::vector<double> row, column;
  std::optional<double> area = {};  ///< over which an irradiance adds up to a power
};
SensorAxes axes_of(const Sensor& sensor);

}  // namespace flatspeckle::grin
