#include <functional>
#include <stdexcept>

#include <doctest/doctest.h>

#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/dynamics/moving_derivatives.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/slab/slab_covariance.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_moving_derivatives {

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

/// Returns values by [parameter][1 + delay][channel], all from the same paths.
std::vector<Complex> values(const Scene& scene, const Motion& at, ReversedPaths reversed,
                            const std::vector<MovingDerivative>& derivatives) {
  const PathJob job =
      moving_derivative_job(scene, sampling_singles(scene, reversed), delays, at, derivatives, 3);
  const GroupedSums sums = tests::summed(job.field.batches, 20000);
  return job.all(sums.total_samples(), sums.total());
}

MovingDerivative by_motion(double diffusion, Vec velocity, double shear) {
  return {{"motion", 0, 0, {}}, diffusion, velocity, shear};
}

Motion moved(const MovingDerivative& derivative, double step) {
  return {motion.diffusion + step * derivative.diffusion,
          motion.velocity + step * derivative.velocity, motion.shear + step * derivative.shear};
}

}  // namespace

TEST_CASE("moving scatterers: fields of the derivative job equal those of the delay job") {
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

TEST_CASE("moving scatterers: derivatives by motion agree with differences of the same paths") {
  const Scene scene = box();
  const std::vector<MovingDerivative> derivatives = {by_motion(1, {}, 0), by_motion(0, {1, 0}, 0),
                                                     by_motion(0, {0, 1}, 0), by_motion(0, {}, 1)};
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const auto found = values(scene, motion, reversed, derivatives);
    const std::size_t count = found.size() / (1 + derivatives.size());
    for (std::size_t p = 0; p < derivatives.size(); ++p) {
      constexpr double step = 1e-4;
      const auto above = values(scene, moved(derivatives[p], step), reversed, {}),
                 below = values(scene, moved(derivatives[p], -step), reversed, {});
      for (std::size_t i = 0; i < count; ++i) {
        const Complex derivative = (above[i] - below[i]) / (2 * step);
        CHECK(std::abs(found[(1 + p) * count + i] - derivative) < 1e-5 * std::abs(found.front()));
      }
    }
  }
}

TEST_CASE("moving scatterers: derivatives by the medium at zero delay equal those of static ones") {
  const Scene scene = box();
  const MediumDerivative by_mu_t = medium_derivative(scene, BulkParameter::mu_t),
                         by_g = medium_derivative(scene, BulkParameter::g);
  const auto found = values(scene, motion, ReversedPaths::yes, {{by_mu_t}, {by_g}});
  const PathJob still =
      derivative_job(scene, sampling_singles(scene, ReversedPaths::yes), {by_mu_t, by_g}, 3);
  const GroupedSums sums = tests::summed(still.field.batches, 20000);
  const auto expected = still.all(sums.total_samples(), sums.total());
  const std::size_t channels = 3, count = found.size() / 3;
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t c = 0; c < channels; ++c)
      CHECK(std::abs(found[p * count + c] - expected[p * channels + c]) <
            1e-9 * std::abs(expected[p * channels]));
}

TEST_CASE("temporal decay of a slab: derivatives by mu_t and g agree with transport") {
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
  const PathJob job = moving_derivative_job(
      slab, sampling_singles(slab, ReversedPaths::no), delays, {},
      {{medium_derivative(slab, BulkParameter::mu_t)}, {medium_derivative(slab, BulkParameter::g)}},
      3);
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

TEST_CASE("path derivatives: unsupported plans and too many parameters are rejected") {
  const Scene scene = box();
  Plan plan = sampling_singles(scene, ReversedPaths::no);
  const std::vector<MediumDerivative> many(most_derivatives + 1, {"mu_t", 1, 0, {}});
  CHECK_THROWS_AS(derivative_job(scene, plan, many, 3), std::logic_error);
  plan.sampled_single = false;  // single scattering with motion has no closed form
  CHECK_THROWS_AS(moving_derivative_job(scene, plan, delays, motion, {}, 3), std::logic_error);
}

}  // namespace flatspeckle::mc::test_moving_derivatives
