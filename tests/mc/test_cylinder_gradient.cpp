#include <doctest/doctest.h>

#include "mc/paths/estimators/gradient.h"
#include "mc/slab/slab_jobs.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_cylinder_gradient {

namespace {

using tests::pi;

struct Cylinders {
  double radius = 0.3, index = 1.5;
};

/// Returns a scene of cylinders in a slab, or in a box of the same depth.
Scene cylinders(const std::string& domain, const Cylinders& of) {
  SceneSpec spec;
  spec.domain = domain;
  spec.depth = 100;
  if (domain == "box") spec.width = 100;
  spec.scatterer = "tm";
  spec.radius = of.radius;
  spec.index = std::to_string(of.index);
  spec.density = 0.02;
  spec.view_angles = {0.3, pi - 0.5};
  return make_scene(spec);
}

/// Returns the derivatives of each view's intensity by radius, then by index.
Estimate derivatives(const Scene& scene, std::uint64_t paths) {
  const GradientJob job = gradient_job(scene, gradient_plan(scene, ReversedPaths::no), 3);
  REQUIRE(job.parameters[1] == "radius");
  REQUIRE(job.parameters[2] == "index");
  const std::size_t entries = scene.request.entries.size();
  return part(jackknife(tests::summed(job.field.batches, paths), job.gradient), entries,
              2 * entries);
}

}  // namespace

TEST_CASE("cylinders in a slab: derivatives by radius and index agree with transport") {
  const Scene scene = cylinders("slab", {});
  const auto found = derivatives(scene, 400000);
  const auto exact =
      jackknife(tests::summed(slab_gradient_job(scene, false, {1e-5}).field.batches, 2),
                slab_gradient_job(scene, false, {1e-5}).gradient);
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    const Complex expected = exact.value[scene.request.entries.size() + e];
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected, 0);
    CHECK(found.error[e] < 0.1 * std::abs(expected));
  }
}

TEST_CASE(
    "nightly: cylinders in a box: derivatives agree with differences at common random numbers") {
  const auto found = derivatives(cylinders("box", {}), 400000);
  const auto entries = [](double radius, double index) {
    return tests::run(cylinders("box", {radius, index}), ReversedPaths::no, 1600000, 5).entries();
  };
  const auto check = [&](const Estimate& above, const Estimate& below, double step,
                         std::size_t first) {
    for (std::size_t e = 0; e < above.value.size(); ++e) {
      const Complex finite_difference = (above.value[e] - below.value[e]) / step;
      const double error =
          std::hypot(std::hypot(above.error[e], below.error[e]) / step, found.error[first + e]);
      CAPTURE(error / std::abs(finite_difference));
      CHECK_WITHIN_4_SIGMA(found.value[first + e], error, finite_difference,
                           0.01 * std::abs(finite_difference));
    }
  };
  check(entries(0.306, 1.5), entries(0.294, 1.5), 0.012, 0);
  check(entries(0.3, 1.52), entries(0.3, 1.48), 0.04, 2);
}

}  // namespace flatspeckle::mc::test_cylinder_gradient
