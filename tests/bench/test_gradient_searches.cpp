#include <cmath>

#include <doctest/doctest.h>

#include "bench/baselines/gradient_searches.h"
#include "grin/design/problem/designer.h"

namespace flatspeckle::bench::test_gradient_searches {

using namespace grin::design;

TEST_CASE("gradient searches: radial lens agrees with least squares") {
  DesignValues values;
  values.form.design = "radial";
  values.form.coefficients = 4;
  std::get<FocusValues>(values.design_target.kinds) = {.directions = 1, .rays_per_direction = 200};
  const DesignScene scene = make_design_scene(values);
  Designer designer(scene);
  DesignState least_squares = designer.begin();
  while (!least_squares.ended) designer.advance(least_squares);

  const FormStart& start = scene.start;
  REQUIRE(start.levels == 1);
  const DesignTask task = scene.design_target->task(scene.walk, false);
  const GradientObjective objective(*task.rays, *task.objective, start.form);
  const double enough = 1.2 * least_squares.search.loss;
  CHECK(objective.loss(start.coefficients) > 100 * enough);
  const SearchLimits limits{bounds_of(start.form, start.least_index, start.most_index), enough,
                            4000};
  for (const SearchResult& found : {by_lbfgs(objective, limits, start.coefficients),
                                    by_adam(objective, limits, start.coefficients, 0.03)}) {
    CAPTURE(found.traces);
    CHECK(found.loss <= enough);
    CHECK(objective.loss(found.coefficients) == doctest::Approx(found.loss));
    CHECK(found.traces < limits.most_traces);
    for (std::size_t i = 0; i < found.coefficients.size(); ++i)
      CHECK(found.coefficients[i] ==
            doctest::Approx(least_squares.search.coefficients[i]).epsilon(0.05));
  }
}

}  // namespace flatspeckle::bench::test_gradient_searches
