#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/design/designer.h"

namespace flatspeckle::grin::design {

namespace {

DesignState designed(const DesignScene& scene, Designer& designer) {
  DesignState state = designer.begin();
  while (!state.ended) designer.advance(state);
  CHECK(!state.stalled);
  CHECK(scene.levels == state.level + 1);
  return state;
}

/// Root mean square and largest distance of the index from that of a lens of this focus, r < 0.9.
std::pair<double, double> index_errors(const FieldForm& form, const std::vector<double>& values,
                                       double focus) {
  double sum = 0, most = 0;
  constexpr int places = 500;
  const auto look = [&](const auto& of) {
    const auto field = of.field(values);
    for (int i = 0; i < places; ++i) {
      const double r = 0.9 * std::cbrt((i + 0.5) / places), z = 2 * std::fmod(0.618034 * i, 1) - 1;
      const double rho = std::sqrt(1 - z * z), turn = 4.1 * i;
      const Vec3 x = r * Vec3(rho * std::cos(turn), rho * std::sin(turn), z);
      const double error = index(field, x) - std::sqrt(1 + focus * focus - r * r) / focus;
      sum += error * error / places;
      most = std::max(most, std::abs(error));
    }
  };
  std::visit(look, form);
  return {std::sqrt(sum), most};
}

DesignValues small_ball() {
  DesignValues values;
  values.nodes = {5, 9};
  values.directions = 20;
  values.rays_per_direction = 40;
  return values;
}

}  // namespace

TEST_CASE("Luneburg's lens is found from n = 1") {
  const DesignScene scene = make_design_scene(small_ball());
  Designer designer(scene);
  const DesignState state = designed(scene, designer);
  const DesignCheck check = designer.check(state);
  CHECK(*check.held_out < 3e-4);
  CHECK(std::abs(*check.held_out_half_step / *check.held_out - 1) < 0.05);
  const auto [rms, most] = index_errors(designer.form(state), state.search.coefficients, 1);
  CHECK(rms < 5e-5);
  CHECK(most < 5e-4);
}

TEST_CASE("A radial profile of eight coefficients is found to 1e-6") {
  DesignValues values;
  values.design = "radial";
  values.directions = 1;
  values.rays_per_direction = 200;
  const DesignScene scene = make_design_scene(values);
  Designer designer(scene);
  const DesignState state = designed(scene, designer);
  const auto [rms, most] = index_errors(designer.form(state), state.search.coefficients, 1);
  CHECK(most < 1e-6);
  CHECK(*designer.check(state).held_out < 3e-6);
}

TEST_CASE("A lens with its focus inside is found") {
  DesignValues values;
  values.design = "radial";
  values.directions = 1;
  values.rays_per_direction = 200;
  values.focus = 0.7;
  const DesignScene scene = make_design_scene(values);
  Designer designer(scene);
  const DesignState state = designed(scene, designer);
  const auto [rms, most] = index_errors(designer.form(state), state.search.coefficients, 0.7);
  CHECK(most < 1e-4);
}

TEST_CASE("Bounds of the index hold") {
  DesignValues values = small_ball();
  values.nodes = {5};
  values.most_index = 1.3;
  const DesignScene scene = make_design_scene(values);
  Designer designer(scene);
  DesignState state = designer.begin();
  while (!state.ended) designer.advance(state);
  double most = 0;
  for (const double c : state.search.coefficients) most = std::max(most, c);
  CHECK(most < 0.3 + 1e-12);
  CHECK(most > 0.29);
}

}  // namespace flatspeckle::grin::design
