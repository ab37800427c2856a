#include <cmath>
#include <filesystem>
#include <fstream>

#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/design/problem/designer.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::design::test_designer {

namespace {

DesignState designed(const DesignScene& scene, Designer& designer) {
  DesignState state = designer.begin();
  while (!state.ended) designer.advance(state);
  CHECK(!state.stalled);
  CHECK(scene.start.levels == state.level + 1);
  return state;
}

/// Returns the RMS and the largest difference, within r < 0.9, between the index and that of a lens
/// of this focus.
std::pair<double, double> index_errors(const FieldForm& form, const std::vector<double>& values,
                                       double focus) {
  double sum = 0, most = 0;
  constexpr int places = 500;
  const auto add_errors = [&](const auto& of) {
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
  std::visit(add_errors, form);
  return {std::sqrt(sum), most};
}

DesignValues focusing(int directions, int rays_per_direction) {
  DesignValues values;
  auto& light = std::get<FocusValues>(values.design_target.kinds);
  light.directions = directions;
  light.rays_per_direction = rays_per_direction;
  light.aperture = 0.995;
  return values;
}
DesignValues small_ball() {
  DesignValues values = focusing(20, 40);
  values.form.nodes = {5, 9};
  return values;
}
DesignValues profile(double focus) {
  DesignValues values = focusing(1, 200);
  values.form.design = "radial";
  auto& light = std::get<FocusValues>(values.design_target.kinds);
  light.focus = focus;
  light.aperture = 1;
  return values;
}
DesignValues fibre(const char* modes, int coefficients) {
  DesignValues values;
  values.form.design = "guide";
  values.form.radius = 25;
  values.form.index = 1.47;
  values.form.delta = 0.01;
  values.form.coefficients = coefficients;
  values.design_target.goal = FibreValues::word;
  std::get<FibreValues>(values.design_target.kinds) = {modes, 200};
  return values;
}

void write(const ScreenPicture& picture, const std::filesystem::path& path) {
  std::ofstream file(path);
  for (std::size_t i = 0; i < picture.values.size(); ++i)
    file << picture.values[i] << ((i + 1) % picture.pixels == 0 ? '\n' : ',');
}

}  // namespace

TEST_CASE("design of a ball from n = 1: agrees with Luneburg's lens") {
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

TEST_CASE("design of radial profiles: agrees with lenses of a focus on the rim and inside") {
  for (const double focus : {1.0, 0.7}) {
    const DesignScene scene = make_design_scene(profile(focus));
    Designer designer(scene);
    const DesignState state = designed(scene, designer);
    CHECK(*designer.check(state).held_out < 2e-6);
    CHECK(*designer.check(state).held_out_half_step < 2e-6);
    const double most = index_errors(designer.form(state), state.search.coefficients, focus).second;
    CHECK(most < (focus == 1 ? 1e-6 : 1e-4));
  }
}

TEST_CASE("design of a fibre without meridional dispersion: agrees with n0 sech(alpha rho)") {
  const DesignScene scene = make_design_scene(fibre("meridional", 8));
  Designer designer(scene);
  const DesignState state = designed(scene, designer);
  const auto form = std::get<GuideForm>(designer.form(state));
  const GradedGuide field = form.field(state.search.coefficients);
  const double n0 = 1.47, n1 = n0 * std::sqrt(1 - 2 * 0.01), alpha = std::acosh(n0 / n1) / 25;
  for (double rho = 0; rho <= 25; rho += 0.5)
    CHECK(std::abs(index(field, Vec3(rho, 0, 0)) - n0 / std::cosh(alpha * rho)) < 1e-5 * (n0 - n1));
}

TEST_CASE(
    "design of a fibre for all modes: exponent agrees with 2 - 12 delta/5, five times as good as "
    "2") {
  const DesignScene scene = make_design_scene(fibre("all", 0));
  Designer designer(scene);
  const DesignState state = designed(scene, designer);
  CHECK(std::abs(state.search.coefficients.front() - (2 - 12 * 0.01 / 5)) < 0.004);
  const DesignCheck check = designer.check(state);
  const double gain = check.start_held_out / *check.held_out_half_step;
  CHECK(gain > 4.8);
  CHECK(gain < 5.2);
}

TEST_CASE("design methods: baselines are rejected") {
  DesignValues values = profile(1);
  values.method = "lbfgs";
  CHECK_THROWS_WITH(make_design_scene(values),
                    "method = lbfgs: must be one of gauss_newton; lbfgs and adam are baselines of "
                    "`bench error`");
}

TEST_CASE("design of a beam shaper: reaches its picture") {
  DesignValues values;
  values.form.design = "box";
  values.form.nodes = {11};
  values.form.most_index = 2;
  values.design_target.goal = ScreenValues::word;
  values.roughness = 1e-5;
  const ScreenPicture picture = [] {
    ScreenPicture made{1.2, 16, {}};
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i)
        made.values.push_back(0.3 + std::exp(-((i - 5) * (i - 5) + (j - 9) * (j - 9)) / 25.0));
    return made;
  }();
  const auto path = std::filesystem::temp_directory_path() / "flatspeckle_design_picture.csv";
  write(picture, path);
  auto& light = std::get<ScreenValues>(values.design_target.kinds);
  light.pictures = {path.string()};
  light.rays_across = flatspeckle::tests::is_night ? 32 : 24;
  const DesignScene scene = make_design_scene(values);
  std::filesystem::remove(path);
  Designer designer(scene);
  DesignState state = designer.begin();
  while (!state.ended) designer.advance(state);
  const DesignCheck check = designer.check(state);
  CHECK(*check.held_out_half_step < 0.05);
  CHECK(*check.held_out_half_step < 0.2 * check.start_held_out);
}

TEST_CASE("design with bounds: the index stays within them") {
  DesignValues values = small_ball();
  values.form.nodes = {5};
  values.form.most_index = 1.3;
  const DesignScene scene = make_design_scene(values);
  Designer designer(scene);
  DesignState state = designer.begin();
  while (!state.ended) designer.advance(state);
  double most = 0;
  for (const double c : state.search.coefficients) most = std::max(most, c);
  CHECK(most < 0.3 + 1e-12);
  CHECK(most > 0.29);
  CHECK(designer.at_bounds(state) > 0);
}

}  // namespace flatspeckle::grin::design::test_designer
