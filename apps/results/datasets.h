#pragma once

#include <span>

#include "core/result/dataset_row.h"

namespace flatspeckle::apps {

// Tables of what subcommands write themselves; those of estimators stand beside these.
extern const DatasetTable validate_table, own_places_table, sweep_axes_table, sweep_table,
    stacked_table, placement_table, optimum_table;
/// In a program that is built with the benchmarks.
std::span<const DatasetTable* const> bench_tables();

}  // namespace flatspeckle::apps
