#include <cmath>

#include <doctest/doctest.h>

#include "mc/fit/plan/fit_plan.h"

namespace flatspeckle::mc::test_fit_plan {

namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

PlanTask plan_of(double patterns) {
  PlanTask task;
  task.scene.domain = "slab";
  task.scene.depth = 2000;
  task.scene.scatterer = "hg";
  task.scene.g = 0.8;
  task.scene.optical_depth = 4;
  task.scene.albedo = 0.98;
  task.scene.covariance = "memory_effect";
  task.scene.view_angles = {0.1, 0.4};
  task.scene.tilts = {1e-4, 3e-4, 6e-4};
  task.free = read_free_parameters({"g=0.5:0.95", "optical_depth=1:20"}, task.scene);
  task.patterns = patterns;
  return task;
}

}  // namespace

TEST_CASE("fit plan: information on the correlation of two fields agrees with the closed form") {
  for (const double r : {0.0, 0.5, 0.95}) {
    const MatrixXcd covariance{{3.0, 3.0 * r}, {3.0 * r, 3.0}}, derivative{{0.0, 3.0}, {3.0, 0.0}};
    const MatrixXd found = field_information(covariance, {derivative});
    CHECK(found(0, 0) == doctest::Approx(2 / std::pow(1 - r * r, 2)));
  }
}

TEST_CASE("fit plan: a common scale has no information if the scale of the fields is unknown") {
  const MatrixXcd covariance{{2.0, Complex(1, 0.5)}, {Complex(1, -0.5), 1.5}};
  CHECK(std::abs(field_information(covariance, {covariance})(0, 0)) < 1e-12);
}

TEST_CASE("fit plan: errors fall as 1 / sqrt(patterns) and grow without one view or tilt") {
  const FitPlan few = fit_plan(plan_of(100)), many = fit_plan(plan_of(10000));
  for (int i = 0; i < 2; ++i) {
    CHECK(few.errors[i] == doctest::Approx(10 * many.errors[i]));
    CHECK(few.patterns_to_percent[i] == doctest::Approx(many.patterns_to_percent[i]));
    CHECK(many.without_view.col(i).minCoeff() > 1);
    CHECK(many.without_tilt.col(i).minCoeff() > 1);
  }
}

TEST_CASE("fit plan: the tilt that is left out is the one without which errors grow least") {
  const PlanTask all = plan_of(1000);
  const FitPlan plan = fit_plan(all);
  Eigen::Index omitted = 0;
  const Eigen::ArrayXd relative = (plan.errors.array() / plan.values.array()).square();
  (plan.without_tilt.array().square().matrix() * relative.matrix()).minCoeff(&omitted);
  PlanTask choice = all;
  choice.most_tilts = 2;
  const FitPlan chosen = fit_plan(choice);
  auto left = plan.tilts;
  left.erase(left.begin() + omitted);
  CHECK(chosen.tilts == left);
  CHECK(chosen.views == plan.views);
  PlanTask direct = all;
  direct.scene.tilts = left;
  const FitPlan expected = fit_plan(direct);
  for (Eigen::Index i = 0; i < expected.errors.size(); ++i) {
    CHECK(chosen.errors[i] == doctest::Approx(expected.errors[i]).epsilon(1e-3));
    CHECK(chosen.growth_by_choice[i] ==
          doctest::Approx(plan.without_tilt(omitted, i)).epsilon(1e-9));
  }
}

}  // namespace flatspeckle::mc::test_fit_plan
