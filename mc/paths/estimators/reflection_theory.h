#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// C_E of the reflected views of a slab in the plane for each tilt of a request with matched views
/// (conventions, C44): light scattered once, as it is, and diffuse light from where it is first
/// scattered to where it is last, both spread over a transport mean free path (Akkermans and
/// Montambaux 2007, chapter 8). Empty where there are no such views, or the medium varies.
std::vector<double> reflected_correlation_theory(const Scene& scene);

extern const DatasetTable reflection_theory_table;

/// Where there is any.
void write_reflection_theory(ResultFile& file, const Scene& scene);

}  // namespace flatspeckle::mc
