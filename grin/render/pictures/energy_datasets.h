#pragma once

#include <optional>

#include "core/result/dataset_row.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin {

extern const DatasetTable energy_table;

/// By Fate; nothing where the method walks no light path to its end.
std::optional<Estimate> energy_result(const RenderJob& job, const GroupedSums& sums);

/// Those fates that the scene has.
void write_energy(ResultFile& file, const RenderScene& scene, const RenderRequest& request,
                  const Estimate& energy);

}  // namespace flatspeckle::grin
