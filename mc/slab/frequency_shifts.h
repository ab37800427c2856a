#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/estimators/changed_fields.h"

namespace flatspeckle::mc {

/// Throws InputError for shifts that are not small, and for matched views past the horizon.
void check_frequency_shifts(const Scene& slab, const std::vector<double>& shifts);

extern const DatasetTable frequency_table;
/// The request's axes must have been written.
void write_frequency_shifts(ResultFile& file, const CovarianceRequest& request,
                            const std::vector<double>& shifts, const ChangeEstimates& found);

}  // namespace flatspeckle::mc
