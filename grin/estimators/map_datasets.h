#pragma once

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "grin/estimators/render_job.h"

namespace flatspeckle::grin {

extern const DatasetTable box_map_table, ring_map_table;

/// Of a job with a map: [cell] each.
struct MapResult {
  Estimate fluence, absorbed;
};
MapResult map_result(const RenderJob& job, const LightMap& map, const GroupedSums& sums);

void write_map(ResultFile& file, const LightMap& map, const MapResult& result);

}  // namespace flatspeckle::grin
