#include "tests/mc/estimates.h"

#include <memory>
#include <sstream>

#include "flatland/media/layers.h"

namespace flatspeckle::mc::tests {

namespace {

SceneSpec hg_spec(double depth, const HgBulk& bulk, double wavelength) {
  SceneSpec spec;
  spec.wavelength = wavelength;
  spec.depth = depth;
  spec.scatterer = "hg";
  spec.g = bulk.g;
  spec.albedo = bulk.albedo;
  spec.mean_free_path = bulk.mean_free_path;
  return spec;
}

}  // namespace

Scene hg_box(double width, double depth, const HgBulk& bulk, const CovarianceRequest& request,
             double wavelength) {
  SceneSpec spec = hg_spec(depth, bulk, wavelength);
  spec.width = width;
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

Scene hg_slab(double depth, const HgBulk& bulk, const CovarianceRequest& request,
              double wavelength) {
  SceneSpec spec = hg_spec(depth, bulk, wavelength);
  spec.domain = "slab";
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

Scene layered(const std::vector<Layer>& layers, const CovarianceRequest& request) {
  std::vector<Material> materials;
  std::vector<double> thicknesses;
  double depth = 0;
  for (const auto& [thickness, optical_depth, g, albedo] : layers) {
    const Scene alone = hg_slab(thickness, {thickness / optical_depth, g, albedo}, request);
    materials.push_back({alone.scatterer, alone.medium});
    thicknesses.push_back(thickness);
    depth += thickness;
  }
  Scene scene = hg_slab(depth, {1, 0, 1}, request);
  scene.profile = std::make_shared<const Layers>(materials, thicknesses);
  scene.medium = scene.profile->mean();
  return scene;
}

std::vector<View> far_views(const std::vector<double>& angles) {
  std::vector<View> views;
  for (double angle : angles) views.push_back(far_view(angle));
  return views;
}

Estimate Run::weighted_sum(const std::vector<double>& weights) const {
  return jackknife(sums, [&](double samples, std::span<const Complex> total) {
    const auto values = job.covariance(samples, total);
    double sum = 0;
    for (std::size_t e = 0; e < values.size(); ++e) sum += weights[e] * values[e].real();
    return std::vector<Complex>{sum};
  });
}

Run run(const Scene& scene, ReversedPaths reversed, std::uint64_t paths, std::uint64_t seed,
        std::uint64_t paths_per_batch) {
  Plan plan = make_plan(scene, reversed);
  if (paths_per_batch > 0) plan.paths_per_batch = paths_per_batch;
  return run(scene, plan, paths, seed);
}

Run run(const Scene& scene, const Plan& plan, std::uint64_t paths, std::uint64_t seed) {
  Run result{covariance_job(scene, plan, flatspeckle::tests::fresh_seed(seed)), {}};
  result.sums = summed(result.job.batches, shortened(paths));
  return result;
}

std::uint64_t shortened(std::uint64_t paths) {
  const double share = paths > 40000 ? effort().samples : 1;
  return static_cast<std::uint64_t>(share * static_cast<double>(paths));
}

GroupedSums summed(const BatchJob& job, std::uint64_t samples) {
  RunOptions options;
  options.stop.samples = samples;
  options.threads = 2;
  RunState state;
  run_batches(job, options, state);
  return std::move(state.sums);
}

std::string text(Complex value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace flatspeckle::mc::tests
