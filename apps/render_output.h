#pragma once

#include "grin/estimators/render_datasets.h"

namespace flatspeckle::apps {

/// Total, mean, brightest pixel, and what the search for curves cost.
void print_render(const grin::RenderScene& scene, const grin::RenderJob& job,
                  const grin::RenderResult& result);

}  // namespace flatspeckle::apps
