#pragma once

#include <string>
#include <vector>

#include "core/numbers/statistics.h"
#include "grin/render/methods/render_scene.h"

namespace flatspeckle::grin {

/// Derivatives of what a sensor has found, by each parameter of the medium (path_score.h) and of
/// the field (moving_paths.h), one parameter after the other. Errors of the latter have what the
/// width of edges does, as far as it is told from chance.
struct PowerGradients {
  Estimate image, mean;
  Estimate within = {};  ///< of sensors that list radii (PowersWithin)
};

/// Of a sensor whose first pixel is that of a batch's sums; theirs have derivatives.
PowerGradients power_gradients(const Sensor& sensor, std::size_t first_pixel, const TimeBins& bins,
                               const GroupedSums& sums);

/// What they are by.
std::vector<std::string> gradient_names(const RenderScene& scene);

}  // namespace flatspeckle::grin
