#pragma once

#include <string>
#include <vector>

#include "core/numbers/statistics.h"
#include "core/result/result_file.h"

namespace flatspeckle::apps {

/// Datasets `name` and `name`_error of an estimate that is real.
void write_estimate(ResultFile& file, const std::string& name, const Estimate& estimate,
                    const std::vector<Axis>& axes, const std::string& units,
                    const std::string& long_name);

}  // namespace flatspeckle::apps
