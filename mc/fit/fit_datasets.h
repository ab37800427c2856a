#pragma once

#include <string>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/fit/medium_fit.h"

namespace flatspeckle::mc {

extern const DatasetTable fit_table;
void write_fit(ResultFile& file, const FitTask& task, const MediumFit& fit);

/// Returns a text about the least determined parameter, such as "mu_s (1 - g) is known to 1.1 %, g
/// alone to 40 %"; empty if all parameters are about as well determined as mu_s (1 - g).
std::string degeneracy(const FitTask& task, const MediumFit& fit);

}  // namespace flatspeckle::mc
