#pragma once

#include <span>
#include <vector>

#include "core/result/dataset_row.h"

namespace flatspeckle::apps {

/// Of all that result files hold, in the order of docs/format.md.
std::vector<const DatasetTable*> all_tables();

// Tables of what subcommands write themselves; those of estimators stand beside these.
extern const DatasetTable validate_table, own_places_table, sweep_axes_table, sweep_table,
    stacked_table, placement_table, optimum_table;
/// In a program that is built with the benchmarks.
std::span<const DatasetTable* const> bench_tables();

}  // namespace flatspeckle::apps
