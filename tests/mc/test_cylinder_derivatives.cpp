#include <doctest/doctest.h>

#include "mc/paths/estimators/gradient.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_cylinder_derivatives {

namespace {

Scene box_of_cylinders(double radius, double index) {
  SceneSpec spec;
  spec.width = 40;
  spec.depth = 20;
  spec.scatterer = "tm";
  spec.radius = radius;
  spec.index = std::to_string(index);
  spec.density = 0.00625;
  spec.view_angles = {0.3, 0.5, 0.7, 1.2, 1.5, 1.8, 2.1, 2.4, 2.9};
  return make_scene(spec);
}

FieldJob intensities(double radius, double index) {
  const std::uint64_t seed = flatspeckle::tests::fresh_seed(5);
  const Scene scene = box_of_cylinders(radius, index);
  return covariance_job(scene, make_plan(scene, ReversedPaths::no), seed);
}

/// Estimates a fourth-order difference with common random numbers; errors are those of the
/// difference.
template <typename At>
Estimate difference(double step, std::uint64_t paths, const At& at) {
  const std::vector<double> weights = {1 / (12 * step), -8 / (12 * step), 8 / (12 * step),
                                       -1 / (12 * step)};
  const std::vector<FieldJob> jobs = {at(-2 * step), at(-step), at(step), at(2 * step)};
  const std::size_t size = jobs.front().batches.size;
  BatchJob all = jobs.front().batches;
  all.size = jobs.size() * size;
  all.run = [&](std::uint64_t number, std::span<Complex> sums) {
    for (std::size_t j = 0; j < jobs.size(); ++j)
      jobs[j].batches.run(number, sums.subspan(j * size, size));
  };
  return jackknife(tests::summed(all, paths), [&](double samples, std::span<const Complex> sums) {
    std::vector<Complex> derivatives(jobs.front().covariance(samples, sums.first(size)).size());
    for (std::size_t j = 0; j < jobs.size(); ++j) {
      const auto values = jobs[j].covariance(samples, sums.subspan(j * size, size));
      for (std::size_t e = 0; e < derivatives.size(); ++e) derivatives[e] += weights[j] * values[e];
    }
    return derivatives;
  });
}

void check_same(const Estimate& derivatives, std::size_t first, const Estimate& differences) {
  std::size_t precise = 0;
  for (std::size_t e = 0; e < differences.value.size(); ++e) {
    const Complex derivative = derivatives.value[first + e];
    const double error = std::hypot(derivatives.error[first + e], differences.error[e]);
    CHECK_WITHIN_4_SIGMA(derivative, error, differences.value[e], 0);
    if (error > 0.01 * std::abs(derivative)) continue;
    ++precise;
    CHECK(std::abs(derivative - differences.value[e]) < 0.03 * std::abs(derivative));
  }
  MESSAGE("errors below 1 %: " << precise << " of " << differences.value.size());
  CHECK(precise >= 6);  // the others are close to 0
}

}  // namespace

TEST_CASE("nightly: cylinders: derivatives by radius and index agree with differences to 3 %") {
  constexpr double radius = 0.35, index = 1.5;
  constexpr std::uint64_t paths = 12000000;
  const Scene scene = box_of_cylinders(radius, index);
  const GradientJob job = gradient_job(scene, gradient_plan(scene, ReversedPaths::no),
                                       flatspeckle::tests::fresh_seed(3));
  REQUIRE(job.parameters[1] == "radius");
  REQUIRE(job.parameters[2] == "index");
  const Estimate derivatives = jackknife(tests::summed(job.field.batches, paths), job.gradient);
  const std::size_t views = scene.request.entries.size();
  check_same(derivatives, views, difference(0.01, paths, [](double more) {
               return intensities(radius + more, index);
             }));
  check_same(derivatives, 2 * views, difference(0.04, paths, [](double more) {
               return intensities(radius, index + more);
             }));
}

}  // namespace flatspeckle::mc::test_cylinder_derivatives
