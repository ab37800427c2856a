// Checks that sums depend only on the seed and the number of samples, bit for bit, and not on the
// number of threads.
#include <doctest/doctest.h>

#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::test_threads {

namespace {

std::vector<Complex> sums_of(const BatchJob& job, std::uint64_t samples, int threads) {
  RunOptions options;
  options.stop.samples = samples;
  options.threads = threads;
  RunState state;
  run_batches(job, options, state);
  return state.sums.state().sums;
}

void check_threads(const BatchJob& job, std::uint64_t samples) {
  const auto one = sums_of(job, samples, 1);
  CHECK(std::abs(one.front()) > 0);
  CHECK(one == sums_of(job, samples, 2));
  CHECK(one == sums_of(job, samples, 4));
}

SceneSpec box(const std::string& scatterer) {
  SceneSpec spec;
  spec.width = 10;
  spec.depth = 5;
  spec.scatterer = scatterer;
  spec.count = 12;
  if (scatterer != "point") spec.radius = 0.2;
  spec.light_angles = {0, 0.3};
  spec.view_angles = {0.1, 2.9};
  return spec;
}

BatchJob mc_job(const SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  return mc::covariance_job(scene, mc::make_plan(scene, mc::ReversedPaths::automatic), 3).batches;
}

}  // namespace

TEST_CASE("Monte Carlo: sums do not depend on threads (points, cylinders, full covariance, slab)") {
  check_threads(mc_job(box("point")), 4000);
  check_threads(mc_job(box("te")), 2000);
  SceneSpec full = box("tm");
  full.covariance = "full";
  check_threads(mc_job(full), 2000);
  SceneSpec slab;
  slab.domain = "slab";
  slab.scatterer = "hg";
  slab.g = 0.7;
  slab.albedo = 0.9;
  slab.depth = 100;
  slab.optical_depth = 3;
  slab.covariance = "memory_effect";
  slab.tilts = {0, 1e-3, 2e-3};
  check_threads(mc_job(slab), 4000);
}

TEST_CASE("exact ensembles: sums do not depend on threads") {
  for (const char* scatterer : {"point", "hard"}) {
    const Scene scene = make_scene(box(scatterer));
    check_threads(wave::wave_job(scene, 3, 1e-6).batches, 40);
  }
}

}  // namespace flatspeckle::test_threads
