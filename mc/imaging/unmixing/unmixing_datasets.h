#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/imaging/unmixing/unmixing.h"

namespace flatspeckle::mc {

extern const DatasetTable unmixing_table;

/// Values of a matrix row by row.
std::vector<double> row_by_row(const Eigen::MatrixXd& matrix);

/// Of frames of these names.
void write_unmixed(ResultFile& file, const std::vector<std::string>& names, const Unmixed& found);

}  // namespace flatspeckle::mc
