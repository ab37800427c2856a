#include "bench/stability/mc_extremes.h"

namespace flatspeckle::bench {

namespace {

SceneSpec hg(const Bulk& bulk) {
  SceneSpec spec;
  spec.depth = bulk.depth;
  spec.scatterer = "hg";
  spec.g = bulk.g;
  spec.albedo = bulk.albedo;
  spec.optical_depth = bulk.optical_depth;
  return spec;
}

}  // namespace

Scene hg_slab(const Bulk& bulk, const CovarianceRequest& request) {
  SceneSpec spec = hg(bulk);
  spec.domain = "slab";
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

Scene hg_box(double width, const Bulk& bulk, const CovarianceRequest& request) {
  SceneSpec spec = hg(bulk);
  spec.width = width;
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

GroupedSums summed(const BatchJob& job, std::uint64_t samples) {
  RunOptions options;
  options.stop.samples = samples;
  options.threads = 1;
  RunState state;
  run_batches(job, options, state);
  return std::move(state.sums);
}

double total_magnitude(const Estimate& found) {
  double sum = 0;
  for (std::size_t e = 0; e < found.value.size(); ++e)
    sum += std::abs(found.value[e]) + found.error[e];
  return sum;
}

Estimate covariance(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t paths,
                    std::uint64_t seed) {
  const FieldJob job = mc::covariance_job(scene, mc::make_plan(scene, reversed), seed);
  return jackknife(summed(job.batches, paths), job.covariance);
}

}  // namespace flatspeckle::bench
