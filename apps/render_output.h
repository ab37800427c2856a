#pragma once

#include <optional>

#include "core/result/result_file.h"
#include "grin/estimators/render_job.h"

namespace flatspeckle::apps {

/// What a run has found, in the shapes of docs/format.md.
struct RenderResult {
  grin::RenderedPicture picture;
  Estimate mean;                  ///< over the pixels
  std::optional<Estimate> total;  ///< power on an area detector
  Estimate pulse;                 ///< mean over the pixels by bin; empty in a steady state
};

RenderResult render_result(const grin::RenderScene& scene, const grin::RenderJob& job,
                           const GroupedSums& sums);

/// length_unit: metres.
void write_render(ResultFile& file, const grin::RenderScene& scene, const grin::RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit);

/// Total, mean, brightest pixel, and what the search for curves cost.
void print_render(const grin::RenderScene& scene, const grin::RenderJob& job,
                  const RenderResult& result);

}  // namespace flatspeckle::apps
