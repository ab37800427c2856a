#include <doctest/doctest.h>

#include "bench/scenes/synthetic_slab.h"
#include "mc/fit/fit_datasets.h"

namespace flatspeckle::mc::test_medium_fit {

namespace {

using bench::slab_task;
using bench::SyntheticSlab;
using Eigen::VectorXd;

const VectorXd truth{{0.8, 0.98, 4}};

/// Fits g and the mean free path of slabs without absorption.
FitTask lossless_task(std::vector<Measurement> measurements) {
  MovingSpec none;
  none.scatterer = "hg";
  FitTask task;
  task.free = read_free_parameters({"g=0.3:0.97", "mean_free_path=200:4000"}, none);
  task.measurements = std::move(measurements);
  return task;
}

const SyntheticSlab& standard() {
  static const SyntheticSlab slab = bench::standard_slab();
  return slab;
}

double relative_error(const MediumFit& fit) {  // mu_s (1 - g)
  return fit.derived.front().error / fit.derived.front().value;
}

}  // namespace

TEST_CASE("medium fit: measurements without noise give the slab's parameters") {
  const MediumFit fit = fit_medium(slab_task(standard().exact()));
  REQUIRE(fit.converged);
  CHECK((fit.estimates - truth).cwiseQuotient(fit.errors).cwiseAbs().maxCoeff() < 0.1);
  CHECK(fit.chi_squared < 0.05);
  CHECK(fit.numerical < 0.05);
}

TEST_CASE("medium fit: noisy measurements give the slab's parameters within their errors") {
  const MediumFit fit = fit_medium(slab_task(standard().measured(1)));
  REQUIRE(fit.converged);
  CHECK((fit.estimates - truth).cwiseQuotient(fit.errors).cwiseAbs().maxCoeff() < 3);
  CHECK(fit.chi_squared < 14 + 4 * std::sqrt(28));
}

TEST_CASE("medium fit: a parameter at its bound stays there") {
  auto task = slab_task(standard().exact());
  task.free[1].upper = 0.97;  // albedo
  for (int i = 0; i < 3; ++i) task.free[i].start = (VectorXd{{0.75, 0.95, 5}})[i];
  const MediumFit fit = fit_medium(task);
  REQUIRE(fit.converged);
  CHECK(fit.estimates[1] == 0.97);
  CHECK(fit.chi_squared > 50);
}

TEST_CASE("medium fit: transmission of a thick slab gives mu_s (1 - g) only, a thin slab adds g") {
  SyntheticSlab slab(20000, 0.8, 1, 30);
  slab.add_curve(0, {1, 2, 3, 4});
  slab.add_transmittance();
  auto task = lossless_task(slab.exact());
  const MediumFit thick = fit_medium(task);
  MESSAGE("thick slab: error of g " << thick.errors[0] << "; " << degeneracy(task, thick));
  CHECK(relative_error(thick) < 0.02);
  CHECK(thick.errors[1] / thick.estimates[1] > 5 * relative_error(thick));
  CHECK(std::abs(thick.correlation(0, 1)) > 0.98);
  CHECK(degeneracy(task, thick).starts_with("mu_s (1 - g) is known to"));

  slab.set_depth(2000);
  slab.add_curve(0.3, {1, 2, 4});
  slab.add_transmittance();
  task.measurements = slab.exact();
  const MediumFit both = fit_medium(task);
  MESSAGE("with a thin slab: error of g " << both.errors[0] << "; " << degeneracy(task, both));
  CHECK(both.errors[0] < thick.errors[0] / 2);
  CHECK(both.errors[1] < thick.errors[1] / 2);
}

}  // namespace flatspeckle::mc::test_medium_fit
