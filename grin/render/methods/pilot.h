#pragma once

#include "grin/render/methods/path_kernels.h"

namespace flatspeckle::grin {

/// Returns the number of flights per path without connections, by a pilot run with batches of paths
/// that can fill SIMD lanes.
double flights_per_path(Transport& transport, const PathKernel& kernel, const TimeBins& bins);

/// Sets the connection parameters of a transport by pilot runs; returns flights per pair.
double tune_connections(Transport& transport, const PathKernel& kernel, const TimeBins& bins,
                        double flights_per_connection, bool curved);

}  // namespace flatspeckle::grin
