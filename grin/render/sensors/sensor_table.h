#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"

namespace flatspeckle::grin {

/// What a kind of sensor calls what it finds.
struct SensorWords {
  std::string name;
  std::vector<DatasetRow> axes;  ///< of a pixel
  std::string unit;              ///< of a pixel and of the mean
  std::string pixel, mean;
  std::string total = {};  ///< a power; none: there is no total, and pulses are of the mean
};

/// Pictures and what they add up to; the same of bins of optical path and beyond them; the mean
/// optical path and the mean of its square; derivatives by parameters of the medium.
DatasetTable sensor_table(const SensorWords& words);

}  // namespace flatspeckle::grin
