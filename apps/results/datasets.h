#pragma once

#include <span>
#include <vector>

#include "core/result/dataset_row.h"

namespace flatspeckle::apps {

/// Returns the tables that define all datasets of result files, in the order of docs/format.md.
std::vector<const DatasetTable*> all_tables();

// Tables of datasets that subcommands write. Tables of estimators are defined next to the
// estimators.
extern const DatasetTable validate_table, own_places_table, sweep_axes_table, sweep_table,
    stacked_table, placement_table, optimum_table;
/// Returns the tables of the benchmarks; defined only in builds with benchmarks.
std::span<const DatasetTable* const> bench_tables();

}  // namespace flatspeckle::apps
