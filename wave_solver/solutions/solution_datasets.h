#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

extern const DatasetTable solution_table;

/// Writes the fields in these directions and at these points (either may be empty) with their axes,
/// the placement, and how far the solution can be trusted.
void write_solution(ResultFile& file, const WaveSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec2>& sensors);

}  // namespace flatspeckle::wave
