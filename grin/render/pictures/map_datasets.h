#pragma once

#include <optional>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin {

extern const DatasetTable box_map_table, ring_map_table;

/// Returns the means of the first sum of each cell.
std::vector<Complex> map_means(double samples, std::span<const Complex> sums, std::size_t cells);

/// Return the fluence rate and the absorbed power density in each cell. first: index of the map's
/// first sum among the sums of a batch.
Estimate fluence(const GroupedSums& sums, std::size_t first, const LightMap& map);
Estimate absorbed(const GroupedSums& sums, std::size_t first, const LightMap& map);

/// Returns the power absorbed within the map in voxels of each label; nullopt without labels.
std::optional<Estimate> absorbed_by_label(const RenderScene& scene, const RenderJob& job,
                                          const GroupedSums& sums);

/// Writes the fluence rate and the absorbed power density of a scene's map; the scene must have
/// one. The absorbed power is 0 without absorption.
void write_map(ResultFile& file, const RenderScene& scene, const RenderJob& job,
               const GroupedSums& sums);

}  // namespace flatspeckle::grin
