#include <functional>
#include <stdexcept>

#include <doctest/doctest.h>

#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/dynamics/moving_slopes.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/slab/slab_covariance.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_moving_slopes {

namespace {

using tests::pi;

const std::vector<double> delays = {0.02, 0.1};
const Motion motion{0.7, {0.3, -0.2}, 0.05};

Scene box() {
  return tests::hg_box(
      20, 10, {4, 0.5, 0.9},
      intensity_request(std::vector<double>{0.2}, tests::far_views({0.1, 1.2, pi - 0.3})));
}

Plan sampling_singles(const Scene& scene, ReversedPaths reversed) {
  Plan plan = gradient_plan(scene, reversed);
  plan.sampled_single = true;
  return plan;
}

/// [parameter][1 + delay][channel] from the same paths.
std::vector<Complex> values(const Scene& scene, const Motion& at, ReversedPaths reversed,
                            const std::vector<MovingSlope>& slopes) {
  const PathJob job =
      moving_slope_job(scene, sampling_singles(scene, reversed), delays, at, slopes, 3);
  const GroupedSums sums = tests::summed(job.field.batches, 20000);
  return job.all(sums.total_samples(), sums.total());
}

MovingSlope by_motion(double diffusion, Vec2 velocity, double shear) {
  return {{"motion", 0, 0, {}}, diffusion, velocity, shear};
}

Motion moved(const MovingSlope& slope, double step) {
  return {motion.diffusion + step * slope.diffusion, motion.velocity + step * slope.velocity,
          motion.shear + step * slope.shear};
}

}  // namespace

TEST_CASE("fields of moving scatterers with slopes are those without") {
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const Scene scene = box();
    const auto found = values(scene, motion, reversed, {});
    const PathJob job = delay_job(scene, sampling_singles(scene, reversed), delays, 3, motion);
    const GroupedSums sums = tests::summed(job.field.batches, 20000);
    const auto expected = job.all(sums.total_samples(), sums.total());
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      CHECK(std::abs(found[i] - expected[i]) < 1e-9 * std::abs(expected.front()));
  }
}

TEST_CASE("derivatives by motion are differences of the same paths") {
  const Scene scene = box();
  const std::vector<MovingSlope> slopes = {by_motion(1, {}, 0), by_motion(0, {1, 0}, 0),
                                           by_motion(0, {0, 1}, 0), by_motion(0, {}, 1)};
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const auto found = values(scene, motion, reversed, slopes);
    const std::size_t count = found.size() / (1 + slopes.size());
    for (std::size_t p = 0; p < slopes.size(); ++p) {
      constexpr double step = 1e-4;
      const auto above = values(scene, moved(slopes[p], step), reversed, {}),
                 below = values(scene, moved(slopes[p], -step), reversed, {});
      for (std::size_t i = 0; i < count; ++i) {
        const Complex slope = (above[i] - below[i]) / (2 * step);
        CHECK(std::abs(found[(1 + p) * count + i] - slope) < 1e-5 * std::abs(found.front()));
      }
    }
  }
}

TEST_CASE("derivatives by the medium are those of still scatterers, and decay with delays") {
  const Scene scene = box();
  const MediumSlope by_mu_t = medium_slope(scene, BulkParameter::mu_t),
                    by_g = medium_slope(scene, BulkParameter::g);
  const auto found = values(scene, motion, ReversedPaths::yes, {{by_mu_t}, {by_g}});
  const PathJob still =
      slope_job(scene, sampling_singles(scene, ReversedPaths::yes), {by_mu_t, by_g}, 3);
  const GroupedSums sums = tests::summed(still.field.batches, 20000);
  const auto expected = still.all(sums.total_samples(), sums.total());
  const std::size_t channels = 3, count = found.size() / 3;
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t c = 0; c < channels; ++c)
      CHECK(std::abs(found[p * count + c] - expected[p * channels + c]) <
            1e-9 * std::abs(expected[p * channels]));
}

TEST_CASE("derivatives of decays through a slab by its medium are those of transport") {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 100;
  spec.scatterer = "hg";
  spec.view_angles = {0.3, pi - 0.5};
  const auto scene = [&](double g, double optical_depth) {
    spec.g = g;
    spec.optical_depth = optical_depth;
    return make_scene(spec);
  };
  const Scene slab = scene(0.5, 3);
  const std::size_t channels = 2, count = channels * (1 + delays.size());
  const PathJob job = moving_slope_job(
      slab, sampling_singles(slab, ReversedPaths::no), delays, {},
      {{medium_slope(slab, BulkParameter::mu_t)}, {medium_slope(slab, BulkParameter::g)}}, 3);
  const Estimate found = jackknife(tests::summed(job.field.batches, 100000), job.all);
  const auto exact = [&](double g, double optical_depth) {
    std::vector<Complex> all;
    for (const double delay : {0.0, delays[0], delays[1]})
      for (const Complex value :
           slab_covariance(scene(g, optical_depth), false, {1e-7}, {.delay = delay}).value)
        all.push_back(value);
    return all;
  };
  const auto check = [&](std::size_t p, double step, const std::vector<Complex>& above,
                         const std::vector<Complex>& below) {
    for (std::size_t i = 0; i < count; ++i)
      CHECK_WITHIN_4_SIGMA(found.value[p * count + i], found.error[p * count + i],
                           (above[i] - below[i]) / step, 0);
  };
  check(1, 2 * 0.01 / 100, exact(0.5, 3.01), exact(0.5, 2.99));
  check(2, 0.02, exact(0.51, 3), exact(0.49, 3));
}

TEST_CASE("derivatives of paths: plans and slopes that would give wrong numbers are rejected") {
  const Scene scene = box();
  Plan plan = sampling_singles(scene, ReversedPaths::no);
  const std::vector<MediumSlope> many(most_slopes + 1, {"mu_t", 1, 0, {}});
  CHECK_THROWS_AS(slope_job(scene, plan, many, 3), std::logic_error);
  plan.sampled_single = false;  // moving slopes have no closed form for them
  CHECK_THROWS_AS(moving_slope_job(scene, plan, delays, motion, {}, 3), std::logic_error);
}

}  // namespace flatspeckle::mc::test_moving_slopes
