#pragma once

#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "grin/ends/path_end.h"
#include "grin/ends/pixel_grid.h"

namespace flatspeckle::grin {

// A kind of sensor is a file with: the sensor; its axes_of(sensor); its End, an end of paths made
// of (sensor, stage), which throws InputError naming the key where it does not fit the stage; its
// values, with the word of the key `sensor` for it; add_keys(keys, values) and
// make_sensor(keys, values, picture). It is listed in sensor.h.
//
// The end tells pixels(), has sample_position(stratum, random), sample_direction(at, stratum,
// random) and towards(at, direction), and position_at(x) of a point on the boundary, if it can be
// hit there. Where it may, it has choose_position(x, random) and choice(position, x) for joins from
// x, and can_be_hit().

/// What all kinds have.
struct Picture {
  Vec3 up;
  PixelGrid pixels;
};

/// Centres of the pixels along rows and columns, and what they measure.
struct SensorAxes {
  std::vector<double> row, column;
  const char* units = "";                          ///< of row and column
  const char *row_name = "", *column_name = "";    ///< in words
  const char *image_units = "", *image_name = "";  ///< of a pixel, for lights of power 1
  std::optional<double> area = {};                 ///< over which an irradiance adds up to a power
};

/// Row and column alone.
SensorAxes axes_of(const PixelGrid& pixels, double half_width, double half_height);

}  // namespace flatspeckle::grin
