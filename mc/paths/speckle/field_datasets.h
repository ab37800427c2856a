#pragma once

#include <optional>
#include <vector>

#include "core/result/dataset_row.h"
#include "mc/paths/speckle/field_drawing.h"

namespace flatspeckle::mc {

extern const DatasetTable field_table;

/// Statistics of all fields (field_statistics.h). No autocorrelation where views are not equally
/// spaced.
struct FieldSummary {
  Estimate mean_contrast, circularity, autocorrelation;
  std::optional<Estimate> grain_width;  ///< in sines, or lengths
};

/// Writes axes, fields and their statistics. tilts: rotations of the light that make the light
/// axis, or none.
FieldSummary write_fields(ResultFile& file, const Scene& scene, const std::vector<double>& tilts,
                          const DrawnFields& drawn);

}  // namespace flatspeckle::mc
