#include <cmath>
#include <memory>
#include <numbers>

#include <omp.h>

#include "bench/cost/cost_measure.h"
#include "bench/scenes/render_scenes.h"
#include "core/run/stopwatch.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::bench {

namespace {

using std::numbers::pi;

/// Returns a function that runs the next batches, about `count` samples in each call. Batches of
/// long paths are small.
std::function<void()> samples(double count, const BatchJob& job) {
  return [=, number = std::make_shared<std::uint64_t>(),
          sums = std::make_shared<std::vector<Complex>>(job.size)] {
    for (double done = 0; done < count; done += job.samples_per_batch) job.run((*number)++, *sums);
  };
}

FieldJob covariance_job(const SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  mc::Plan plan = mc::make_plan(scene, mc::ReversedPaths::no);
  plan.paths_per_batch = 100;
  return mc::covariance_job(scene, plan, 1);
}

SceneSpec slab(double optical_depth) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 1000;
  spec.scatterer = "hg";
  spec.optical_depth = optical_depth;
  spec.covariance = "memory_effect";
  for (int t = 0; t < 8; ++t) spec.tilts.push_back(std::asin(2.0 * t / 7 / (2 * pi * 1000)));
  return spec;
}

/// Cost of a path against optical depth. In isotropic illumination the mean path length equals the
/// mean chord, independent of the optical depth.
CostRun path_against_depth() {
  return cost_run({"100 paths, Monte Carlo", "optical depth", 2, 256, 1,
                   [](double depth) { return samples(100, covariance_job(slab(depth)).batches); }});
}

/// Returns the CPU seconds to an error of 1 % of the memory effect in transmission.
double seconds_to_one_percent(const FieldJob& job, double cpu_seconds) {
  GroupedSums sums(job.batches.size);
  std::vector<Complex> batch(job.batches.size);
  const double start = thread_cpu_seconds();
  while (thread_cpu_seconds() - start < cpu_seconds || sums.batches() < 128) {
    std::fill(batch.begin(), batch.end(), 0);
    job.batches.run(sums.batches(), batch);
    sums.add(job.batches.samples_per_batch, batch);
  }
  const double spent = thread_cpu_seconds() - start;
  return spent * std::pow(job.batches.relative_error(sums) / 0.01, 2);
}

/// Cost of an error of 1 % against optical depth. About 1 / depth of the paths are transmitted, and
/// each path costs about `depth`.
CostRun error_against_depth() {
  const std::string what = "an error of 1 %, Monte Carlo";
  return {what, [what](double cpu_seconds) {
            omp_set_num_threads(1);
            constexpr int sizes = 6;
            CostCurve curve{what, "optical depth", {}, {}};
            for (double depth = 2; curve.size.size() < sizes; depth *= 2) {
              curve.size.push_back(depth);
              curve.cpu_s.push_back(
                  seconds_to_one_percent(covariance_job(slab(depth)), cpu_seconds / sizes));
            }
            curve.expected = 2;
            fit_exponent(curve);
            return curve;
          }};
}

/// Cost of deterministic transport against optical depth. The doubling method needs one more step
/// when the depth doubles.
CostRun solution_against_depth() {
  return cost_run({"memory effect to 1e-6, transport", "optical depth", 2, 4096, 0,
                   [](double depth) -> std::function<void()> {
                     return [scene = make_scene(slab(depth))] {
                       mc::slab_covariance(scene, false, {1e-6});
                     };
                   }});
}

/// The scene box_points with 4 illuminations and `channels` / 4 detection directions.
SceneSpec box(double channels, const std::string& covariance) {
  constexpr int lights = 4;
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.optical_depth = 1;
  spec.covariance = covariance;
  spec.light_angles.clear();
  spec.view_angles.clear();
  for (int i = 0; i < lights; ++i) spec.light_angles.push_back(-0.4 + 0.2 * i);
  const int views = static_cast<int>(channels) / lights;
  for (int v = 0; v < views; ++v) spec.view_angles.push_back(-1.2 + 2.4 * (v + 0.5) / views);
  return spec;
}

CostRun intensities_against_channels() {
  return cost_run({"100 paths, intensities", "channels", 256, 8192, 1, [](double channels) {
                     return samples(100, covariance_job(box(channels, "intensity")).batches);
                   }});
}

CostRun full_against_channels() {
  return cost_run({"100 paths, full covariance", "channels", 32, 1024, 2, [](double channels) {
                     return samples(100, covariance_job(box(channels, "full")).batches);
                   }});
}

CostRun render_against_depth() {
  constexpr double mean_chord = 4.0 / 3;
  return cost_run(
      {"128 pairs of paths, bidirectional", "optical depth", 1, 128, 1, [](double depth) {
         grin::RenderScene scene = even_luneburg();
         scene.field = grin::Homogeneous{};
         scene.stage.medium.mu_s = depth / mean_chord;
         return samples(128, render_job(scene, {grin::RenderMethod::bidirectional}, 1).batches);
       }});
}

}  // namespace

std::vector<CostRun> transport_cost_runs() {
  return {path_against_depth(),           error_against_depth(),   solution_against_depth(),
          intensities_against_channels(), full_against_channels(), render_against_depth()};
}

}  // namespace flatspeckle::bench
