#pragma once

#include <vector>

namespace flatspeckle::bench {

/// Of one value or more.
double median(std::vector<double> values);

}  // namespace flatspeckle::bench
