#pragma once

#include <vector>

#include "core/result/dataset_row.h"

namespace flatspeckle::apps {

/// Of all that result files hold, in the order of docs/format.md.
std::vector<const DatasetTable*> all_tables();

}  // namespace flatspeckle::apps
