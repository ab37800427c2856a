#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Returns the theoretical field correlation C_E of the reflected views of a 2D slab, for each tilt
/// of a request with matched views (conventions, C44). The contribution of light scattered once is
/// exact. Diffuse light travels from a first to a last scatterer, whose depths are distributed over
/// a transport mean free path (Akkermans and Montambaux [akkermans2007], chapter 8). Returns an
/// empty list if there are no reflected matched views, if the medium varies, or if faces may
/// reflect.
std::vector<double> reflected_correlation_theory(const Scene& scene);

extern const DatasetTable reflection_theory_table;

/// Writes the theory, if there is any.
void write_reflection_theory(ResultFile& file, const Scene& scene);

}  // namespace flatspeckle::mc
