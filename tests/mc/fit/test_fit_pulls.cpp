#include <doctest/doctest.h>

#include "bench/scenes/synthetic_slab.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::mc {

TEST_CASE("pulls of a slab's parameters are standard normal, and their scatter is the bound") {
  constexpr int sets = 100;
  const Eigen::VectorXd truth{{0.8, 0.98, 4}};
  const auto slab = bench::standard_slab();
  const Eigen::VectorXd bound = fit_medium(bench::slab_task(slab.exact())).errors;
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(3), squares = sum, scatter = sum;
  const double before = process_cpu_seconds();
  for (unsigned seed = 1; seed <= sets; ++seed) {
    const MediumFit fit = fit_medium(bench::slab_task(slab.measured(seed)));
    REQUIRE(fit.converged);
    const Eigen::ArrayXd off = fit.estimates - truth, pull = off / fit.errors.array();
    sum += pull;
    squares += pull.square();
    scatter += off.square();
  }
  MESSAGE("CPU seconds of a fit: " << (process_cpu_seconds() - before) / sets);
  for (int i = 0; i < 3; ++i) {
    const double mean = sum[i] / sets, width = std::sqrt(squares[i] / sets - mean * mean),
                 ratio = std::sqrt(scatter[i] / sets) / bound[i];
    MESSAGE("mean " << mean << ", width " << width << ", scatter over the bound " << ratio);
    CHECK(std::abs(mean) < 0.2);
    CHECK(std::abs(width - 1) < 0.15);
    CHECK(ratio < 1.2);
  }
}

}  // namespace flatspeckle::mc
