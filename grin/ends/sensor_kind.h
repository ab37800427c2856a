#pragma once

#include "core/keys/keys.h"
#include "core/result/dataset_row.h"
#include "grin/ends/path_end.h"
#include "grin/ends/pixel_grid.h"

namespace flatspeckle::grin {

// A kind of sensor is a file with: the sensor; table_of(sensor), what its result file has, and its
// picture_of(sensor); its End, an end of paths made
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

}  // namespace flatspeckle::grin
