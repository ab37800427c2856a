#pragma once

#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/estimators/gradient.h"

namespace flatspeckle::apps {

/// Prints derivatives and writes them in the shapes of docs/format.md. The request's axes must have
/// been written.
void write_gradient(ResultFile& file, const Scene& scene, const mc::GradientJob& job,
                    const GroupedSums& sums);

}  // namespace flatspeckle::apps
