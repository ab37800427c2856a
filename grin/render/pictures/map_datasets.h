#pragma once

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin {

extern const DatasetTable box_map_table, ring_map_table;

/// Means of the first value of each cell.
std::vector<Complex> map_means(double samples, std::span<const Complex> sums, std::size_t cells);

/// [cell], of sums of which those of a map begin at `first`.
Estimate fluence(const GroupedSums& sums, std::size_t first, const LightMap& map);
Estimate absorbed(const GroupedSums& sums, std::size_t first, const LightMap& map);

/// Writes the map of a scene that has one: fluence, and absorbed power, which is 0 without
/// absorption.
void write_map(ResultFile& file, const RenderScene& scene, const RenderJob& job,
               const GroupedSums& sums);

}  // namespace flatspeckle::grin
