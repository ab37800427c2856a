#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "grin/render/pictures/render_job.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::tests {

using flatspeckle::tests::is_night;

inline std::string name(RenderMethod method) {
  return method_word(method);
}

/// A picture and its cost.
struct Rendered {
  RenderedPicture picture;
  TransportCounts counts;
  double cpu_s = 0, samples = 0;

  double value(std::size_t pixel = 0) const { return picture.steady.value[pixel].real(); }
  double error(std::size_t pixel = 0) const { return picture.steady.error[pixel]; }
};

inline RunState run_render(const RenderJob& job, const StopRule& stop, int threads = 0) {
  RunState state{GroupedSums(job.batches.size), {}};
  RunOptions options;
  options.stop = stop;
  options.threads = threads;
  run_batches(job.batches, options, state);
  return state;
}
inline StopRule after(double samples) {
  StopRule stop;
  stop.samples = static_cast<std::uint64_t>(samples);
  return stop;
}
inline RunState run_render(const RenderJob& job, double samples, int threads = 0) {
  return run_render(job, after(samples), threads);
}

inline Rendered rendered(const RenderScene& scene, const RenderRequest& request,
                         const StopRule& stop, std::uint64_t seed = 1) {
  const RenderJob job = render_job(scene, request, flatspeckle::tests::fresh_seed(seed));
  const RunState state = run_render(job, stop);
  return {rendered_picture(job, state.sums), transport_counts(job, state.sums), state.cpu_s,
          state.sums.total_samples()};
}
inline Rendered rendered(const RenderScene& scene, const RenderRequest& request, double samples,
                         std::uint64_t seed = 1) {
  return rendered(scene, request, after(samples), seed);
}

inline Rendered rendered(const RenderScene& scene, RenderMethod method, double samples,
                         std::uint64_t seed = 1) {
  return rendered(scene, RenderRequest{method}, samples, seed);
}

/// Returns the mean over the pixels with its error. Pixels share light paths, so the error is
/// estimated from the batches and not from the pixels.
inline Estimate pixel_mean(const RenderJob& job, const RunState& state) {
  return jackknife(state.sums, [&](double samples, std::span<const Complex> sums) {
    const auto per_pixel = static_cast<std::size_t>(job.bins.sums());
    const auto parts = static_cast<std::size_t>(job.bins.parts());
    Complex total = 0;
    for (std::size_t i = 0; i < job.pictures; ++i)
      if (i % per_pixel < parts) total += sums[i];
    return std::vector<Complex>{total / (samples * static_cast<double>(job.pictures))};
  });
}

}  // namespace flatspeckle::grin::tests
