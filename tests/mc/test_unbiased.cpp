#include <doctest/doctest.h>

#include "bench/oracles/textbook.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

// Comparison with the textbook estimator to 0.1 %, which takes minutes.

namespace flatspeckle::mc::test_unbiased {

namespace {

using tests::pi;

constexpr double target = 1e-3;

Estimate run_to_target(const FieldJob& job) {
  RunState state;
  RunOptions options;
  options.stop.target_error = target;
  run_batches(job.batches, options, state);
  return jackknife(state.sums, job.covariance);
}

void check_unbiased(const Scene& scene, ReversedPaths reversed) {
  const Plan plan = make_plan(scene, reversed);
  const auto found = run_to_target(covariance_job(scene, plan, flatspeckle::tests::fresh_seed(21)));
  const auto expected = run_to_target(
      oracles::textbook_job(scene, plan.reversed, 400, flatspeckle::tests::fresh_seed(22)));
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    CAPTURE(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], expected.error[e]),
                         expected.value[e], 0.0);
  }
}

Scene box(const std::string& scatterer, const CovarianceRequest& request) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.scatterer = scatterer;
  spec.count = scatterer == "tm" ? 67 : 31;
  if (scatterer == "tm") {
    spec.radius = 1 / (2 * pi);
    spec.index = "1.5";
  }
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

}  // namespace

TEST_CASE("nightly: boxes of points and of cylinders agree with the textbook estimator to 0.1 %") {
  const auto request = memory_effect_request(2 * pi, 0, {0.1, 0.8, pi - 0.3}, {0.04, 0.16});
  for (const char* scatterer : {"point", "tm"})
    check_unbiased(box(scatterer, request), ReversedPaths::yes);
}

TEST_CASE("nightly: slabs at optical depth 10 agree with the textbook estimator to 0.1 %") {
  const auto request = memory_effect_request(2 * pi, 0, {0}, {0.0002, 0.0005});
  for (const double g : {0.0, 0.9})
    for (const double albedo : {1.0, 0.9})
      check_unbiased(tests::hg_slab(1000, {100, g, albedo}, request), ReversedPaths::no);
}

}  // namespace flatspeckle::mc::test_unbiased
