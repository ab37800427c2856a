#include <doctest/doctest.h>

#include "tests/mc/fit/synthetic_slab.h"

namespace flatspeckle::mc {

namespace {

using Eigen::VectorXd;
using tests::slab_task;

const VectorXd truth{{0.8, 0.98, 4}};

}  // namespace

TEST_CASE("without noise a slab's parameters are found again") {
  const MediumFit fit = fit_medium(slab_task(tests::standard_slab().exact()));
  REQUIRE(fit.converged);
  CHECK((fit.estimates - truth).cwiseQuotient(fit.errors).cwiseAbs().maxCoeff() < 0.1);
  CHECK(fit.chi_squared < 0.05);
  CHECK(fit.numerical < 0.05);
}

TEST_CASE("with noise a slab's parameters are found within their errors") {
  const MediumFit fit = fit_medium(slab_task(tests::standard_slab().measured(1)));
  REQUIRE(fit.converged);
  CHECK((fit.estimates - truth).cwiseQuotient(fit.errors).cwiseAbs().maxCoeff() < 3);
  CHECK(fit.chi_squared < 14 + 4 * std::sqrt(28));
}

TEST_CASE("a parameter at its bound stays there") {
  auto task = slab_task(tests::standard_slab().exact());
  task.free[1].upper = 0.97;  // of the albedo
  const MediumFit fit = fit_medium(task);
  REQUIRE(fit.converged);
  CHECK(fit.estimates[1] == 0.97);
  CHECK(fit.chi_squared > 50);
}

}  // namespace flatspeckle::mc
