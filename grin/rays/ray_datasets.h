#pragma once

#include "core/result/dataset_row.h"

namespace flatspeckle::grin {

/// Of traced rays and of curves between two points.
extern const DatasetTable rays_table;

}  // namespace flatspeckle::grin
