#include <doctest/doctest.h>

#include "mc/estimators/gradient.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc {

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

Estimate intensities(double radius, double index) {
  return tests::run(box_of_cylinders(radius, index), ReversedPaths::no, 4000000, 5).entries();
}

/// Of fourth order, with the same random numbers at all steps; errors as if they were not.
template <typename At>
Estimate difference(double step, const At& at) {
  const Estimate far_below = at(-2 * step), below = at(-step), above = at(step),
                 far_above = at(2 * step);
  Estimate found = above;
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    found.value[e] =
        (8.0 * (above.value[e] - below.value[e]) - far_above.value[e] + far_below.value[e]) /
        (12 * step);
    found.error[e] =
        std::hypot(8 * above.error[e], 8 * below.error[e], far_above.error[e]) / (12 * step);
  }
  return found;
}

void check_same(const Estimate& slopes, std::size_t first, const Estimate& differences) {
  std::size_t precise = 0;
  for (std::size_t e = 0; e < differences.value.size(); ++e) {
    const Complex slope = slopes.value[first + e];
    const double error = std::hypot(slopes.error[first + e], differences.error[e]);
    CHECK_WITHIN_4_SIGMA(slope, error, differences.value[e], 0);
    if (error > 0.01 * std::abs(slope)) continue;
    ++precise;
    CHECK(std::abs(slope - differences.value[e]) < 0.03 * std::abs(slope));
  }
  MESSAGE("known to 1 %: " << precise << " of " << differences.value.size());
  CHECK(precise >= 3);
}

}  // namespace

TEST_CASE("derivatives by radius and index are differences to 3 sigma of 1 %") {
  constexpr double radius = 0.35, index = 1.5;
  const Scene scene = box_of_cylinders(radius, index);
  const GradientJob job = gradient_job(scene, gradient_plan(scene, ReversedPaths::no), 3);
  REQUIRE(job.parameters[1] == "radius");
  REQUIRE(job.parameters[2] == "index");
  const Estimate slopes = jackknife(tests::summed(job.field.batches, 4000000), job.gradient);
  const std::size_t views = scene.request.entries.size();
  check_same(slopes, views,
             difference(0.01, [](double more) { return intensities(radius + more, index); }));
  check_same(slopes, 2 * views,
             difference(0.02, [](double more) { return intensities(radius, index + more); }));
}

}  // namespace flatspeckle::mc
