#pragma once

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "grin/connections/connection.h"

namespace flatspeckle::grin {

extern const DatasetTable trials_table;

/// How the trials of curves ended, and their iterations.
void write_trials(ResultFile& file, const ConnectionStatistics& statistics);
/// The pairs of points that curves were sought between, and what K cost (C26).
void write_pairs(ResultFile& file, const ConnectionStatistics& statistics);

}  // namespace flatspeckle::grin
