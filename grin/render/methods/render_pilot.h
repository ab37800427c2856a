#pragma once

#include "grin/render/methods/path_kernels.h"

namespace flatspeckle::grin {

/// Before all batches a few pairs of paths, of the scene alone, tell how joins are drawn and
/// weighed: sets joined_share, kept and join_level of the transport, which the kernel is for. What
/// a join costs is given in flights. Bounded in work, whatever the scene. Returns the flights of a
/// pair, infinity where paths were too long to be walked to their ends.
double tune_joins(Transport& transport, const PathKernel& kernel, const TimeBins& bins,
                  double flights_per_join);

/// The latter alone, of paths without joins that go side by side, some at once.
double flights_per_path(Transport& transport, const PathKernel& kernel, const TimeBins& bins);

}  // namespace flatspeckle::grin
