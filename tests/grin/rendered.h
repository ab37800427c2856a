#pragma once

#include "grin/render_job.h"

namespace flatspeckle::grin::tests {

/// A picture of at least so many samples, on `threads` threads.
inline RenderedPicture rendered(const RenderScene& scene, const RenderRequest& request,
                                std::uint64_t samples, std::uint64_t seed = 1, int threads = 1) {
  const RenderJob job = render_job(scene, request, seed);
  RunState state{GroupedSums(job.batches.size), {}};
  run_batches(job.batches, {.stop = {.samples = samples}, .threads = threads}, state);
  return rendered_picture(job, state.sums);
}

}  // namespace flatspeckle::grin::tests
