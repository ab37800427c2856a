#include <functional>

#include <doctest/doctest.h>

#include "bench/scenes/synthetic_slab.h"
#include "core/run/stopwatch.h"
#include "tests/mc/fit/moving_media.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_fit_residuals {

namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;

constexpr int sets = 400;

/// Checks that (estimate - truth) / error over sets of measurements of one medium is standard
/// normal. Returns the root mean square of (estimate - truth).
ArrayXd check_normalised_residuals(const VectorXd& truth,
                                   const std::function<FitTask(unsigned)>& task) {
  ArrayXd sum = ArrayXd::Zero(truth.size()), squares = sum, scatter = sum;
  const double before = process_cpu_seconds();
  for (int set = 1; set <= sets; ++set) {
    const MediumFit fit =
        fit_medium(task(static_cast<unsigned>(flatspeckle::tests::fresh_seed(set))));
    REQUIRE(fit.converged);
    const ArrayXd off = fit.estimates - truth, normalised = off / fit.errors.array();
    sum += normalised;
    squares += normalised.square();
    scatter += off.square();
  }
  MESSAGE("CPU seconds per fit: " << (process_cpu_seconds() - before) / sets);
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const double mean = sum[i] / sets, width = std::sqrt(squares[i] / sets - mean * mean);
    MESSAGE("mean " << mean << ", width " << width);
    CHECK(std::abs(mean) < 4 / std::sqrt(sets));
    CHECK(std::abs(width - 1) < 4 / std::sqrt(2 * sets));
  }
  return (scatter / sets).sqrt();
}

}  // namespace

TEST_CASE(
    "nightly: fit of a slab: normalised residuals are standard normal, scatter meets the bound") {
  const auto slab = bench::standard_slab();
  const VectorXd bound = fit_medium(bench::slab_task(slab.exact())).errors;
  const ArrayXd scatter = check_normalised_residuals(VectorXd{{0.8, 0.98, 4}}, [&](unsigned seed) {
    return bench::slab_task(slab.measured(seed));
  });
  for (int i = 0; i < 3; ++i) CHECK(scatter[i] < (1 + 4 / std::sqrt(2 * sets)) * bound[i]);
}

TEST_CASE("nightly: fit of decays: normalised residuals are standard normal") {
  const auto slab = bench::diffusing_slab();
  check_normalised_residuals(VectorXd{{1, 8}}, [&](unsigned seed) {
    return bench::motion_task(slab.measured(seed), {"diffusion=0.1:10", "optical_depth=3:20"});
  });
}

TEST_CASE("nightly: fit of contrasts: normalised residuals are standard normal") {
  const auto slab = bench::exposed_slab();
  check_normalised_residuals(VectorXd{{1, bench::SyntheticSlab::beta}}, [&](unsigned seed) {
    auto measurements = slab.measured(seed);
    for (auto& one : measurements) one.curves.front().scene.optical_depth = 8;
    return bench::motion_task(measurements, {"diffusion=0.1:10", "beta=0.2:1"});
  });
}

TEST_CASE("nightly: fit of shear by Monte Carlo: normalised residuals are standard normal") {
  const bench::ShearedSlab slab(4000000);
  check_normalised_residuals(VectorXd{{bench::ShearedSlab::diffusion, bench::ShearedSlab::shear}},
                             [&](unsigned seed) { return slab.task(seed, 0.03); });
}

}  // namespace flatspeckle::mc::test_fit_residuals
