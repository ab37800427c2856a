#pragma once

#include "core/result/result_file.h"
#include "grin/connections/connection.h"

namespace flatspeckle::apps {

/// trials/: how the trials of curves ended, and their iterations.
void write_trials(ResultFile& file, const grin::ConnectionStatistics& statistics);
/// trials/: the pairs of points that curves were sought between, and what K cost (C26).
void write_pairs(ResultFile& file, const grin::ConnectionStatistics& statistics);

}  // namespace flatspeckle::apps
