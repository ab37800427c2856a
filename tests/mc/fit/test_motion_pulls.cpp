#include <functional>

#include <doctest/doctest.h>

#include "bench/scenes/moving_media.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::mc {

namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;

/// Pulls over sets of measurements of one medium.
void check_pulls(const VectorXd& truth, int sets, const std::function<FitTask(unsigned)>& task) {
  ArrayXd sum = ArrayXd::Zero(truth.size()), squares = sum;
  const double before = process_cpu_seconds();
  for (int seed = 1; seed <= sets; ++seed) {
    const MediumFit fit = fit_medium(task(static_cast<unsigned>(seed)));
    REQUIRE(fit.converged);
    const ArrayXd pull = (fit.estimates - truth).array() / fit.errors.array();
    sum += pull;
    squares += pull.square();
  }
  MESSAGE("CPU seconds of a fit: " << (process_cpu_seconds() - before) / sets);
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const double mean = sum[i] / sets, width = std::sqrt(squares[i] / sets - mean * mean);
    MESSAGE("mean " << mean << ", width " << width);
    CHECK(std::abs(mean) < 0.2);
    CHECK(std::abs(width - 1) < 0.15);
  }
}

}  // namespace

TEST_CASE("pulls of diffusion and optical depth from decays are standard normal") {
  const auto slab = bench::diffusing_slab();
  check_pulls(VectorXd{{1, 8}}, 100, [&](unsigned seed) {
    return bench::motion_task(slab.measured(seed), {"diffusion=0.1:10", "optical_depth=3:20"});
  });
}

TEST_CASE("pulls of diffusion and beta from contrasts are standard normal") {
  // noise of the first hundred happens to be 2.5 standard errors off in the first of four values,
  // and pulls 0.31
  constexpr int sets = 400;
  const auto slab = bench::exposed_slab();
  check_pulls(VectorXd{{1, bench::SyntheticSlab::beta}}, sets, [&](unsigned seed) {
    auto measurements = slab.measured(seed);
    for (auto& one : measurements) one.curves.front().scene.optical_depth = 8;
    return bench::motion_task(measurements, {"diffusion=0.1:10", "beta=0.2:1"});
  });
}

TEST_CASE("pulls of diffusion and shear by Monte Carlo are standard normal") {
  const bench::ShearedSlab slab(4000000);
  check_pulls(VectorXd{{bench::ShearedSlab::diffusion, bench::ShearedSlab::shear}}, 100,
              [&](unsigned seed) { return slab.task(seed, 0.03); });
}

}  // namespace flatspeckle::mc
