#include <doctest/doctest.h>

#include "tests/mc/fit/moving_media.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_motion_fit {

namespace {

using Eigen::VectorXd;

void check_found(FitTask task, const VectorXd& truth, double most) {
  for (std::size_t i = 0; !flatspeckle::tests::is_night && i < task.free.size(); ++i)
    task.free[i].start = 1.2 * truth[static_cast<Eigen::Index>(i)];  // one start instead of a grid
  const MediumFit fit = fit_medium(task);
  REQUIRE(fit.converged);
  const VectorXd normalised = (fit.estimates - truth).cwiseQuotient(fit.errors);
  CAPTURE(normalised.transpose());
  CHECK(normalised.cwiseAbs().maxCoeff() < most);
}

}  // namespace

TEST_CASE("motion fit: decays give diffusion and optical depth, contrasts diffusion and beta") {
  check_found(bench::motion_task(bench::diffusing_slab().exact(),
                                 {"diffusion=0.1:10", "optical_depth=3:20"}),
              VectorXd{{1, 8}}, 0.1);
  auto contrasts = bench::exposed_slab().exact();
  contrasts.front().curves.front().scene.optical_depth = 8;
  check_found(bench::motion_task(contrasts, {"diffusion=0.1:10", "beta=0.2:1"}),
              VectorXd{{1, bench::SyntheticSlab::beta}}, 0.1);
}

TEST_CASE("motion fit: decays in several views separate shear from diffusion") {
  check_found(bench::ShearedSlab().task(1, 0.03),
              VectorXd{{bench::ShearedSlab::diffusion, bench::ShearedSlab::shear}}, 4);
}

}  // namespace flatspeckle::mc::test_motion_fit
