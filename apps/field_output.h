#pragma once

#include <vector>

#include "apps/field_drawing.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

/// Writes axes, fields and their statistics, and says on standard output how the latter compare
/// with those of a circular Gaussian field. tilts: rotations of the light that make the light axis,
/// or none.
void write_fields(ResultFile& file, const Scene& scene, const std::vector<double>& tilts,
                  const DrawnFields& drawn);

}  // namespace flatspeckle::apps
