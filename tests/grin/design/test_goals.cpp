#include <cmath>
#include <fstream>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/design/adjoint/reading.h"
#include "grin/design/goals/screen_aim.h"
#include "grin/design/problem/design_scene.h"

namespace flatspeckle::grin::design::test_goals {

namespace {

using Numbers = std::vector<double>;

Numbers some(std::size_t count, double middle, double size, std::uint64_t stream) {
  RandomStream random(1, stream, 0);
  Numbers values(count);
  for (double& v : values) v = middle + size * (2 * random.uniform() - 1);
  return values;
}

/// The loss of a task, and its derivatives by all coefficients against differences: along all of
/// them at once to 1e-8, by each of some to 1e-8 of the largest.
struct LossCase {
  DesignTask task;
  FieldForm form;
  Numbers at;
  double difference = 2e-3;

  Objective objective() const { return {*task.rays, *task.goal, form}; }
  double moved(const Numbers& along, double by) const {
    Numbers values = at;
    for (std::size_t i = 0; i < at.size(); ++i) values[i] += by * along[i];
    return objective().loss(values);
  }
  /// Extrapolated twice.
  double by_differences(const Numbers& along) const {
    const auto central = [&](double h) { return (moved(along, h) - moved(along, -h)) / (2 * h); };
    const double d0 = central(difference), d1 = central(difference / 2),
                 d2 = central(difference / 4);
    const double e0 = (4 * d1 - d0) / 3, e1 = (4 * d2 - d1) / 3;
    return (16 * e1 - e0) / 15;
  }
  Numbers gradient() const { return objective().gradient(*objective().residuals(at)); }
};

void check_gradient(const LossCase& one) {
  const Numbers gradient = one.gradient();
  const std::size_t count = gradient.size();
  const Numbers along = some(count, 0, 1, 7);
  double slope = 0, largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    slope += gradient[i] * along[i];
    largest = std::max(largest, std::abs(gradient[i]));
  }
  CHECK(std::abs(slope / one.by_differences(along) - 1) < 1e-8);
  for (std::size_t i = 0; i < count; i += std::max<std::size_t>(1, count / 20)) {
    Numbers unit(count, 0.0);
    unit[i] = 1;
    CHECK(std::abs(one.by_differences(unit) - gradient[i]) < 1e-8 * largest);
  }
}

LossCase case_of(const DesignValues& values, double middle, double size) {
  const DesignScene scene = make_design_scene(values);
  return {scene.aim->task(scene.walk, false), scene.start.form,
          some(shape_of(scene.start.form).size(), middle, size, 3)};
}

DesignValues lens(const char* design, double focus) {
  DesignValues values;
  values.form.design = design;
  if (values.form.design == "ball") values.form.nodes = {6};
  auto& light = std::get<FocusValues>(values.aim.kinds);
  light.focus = focus;
  light.directions = 3;
  light.rays_per_direction = 7;
  light.aperture = 0.9;
  return values;
}
DesignValues fibre(int coefficients) {
  DesignValues values;
  values.form.design = "guide";
  values.form.delta = 0.05;
  values.form.coefficients = coefficients;
  values.step = 0.141;  // rays turn within a step: at its end what they do has a kink
  values.aim.goal = FibreValues::word;
  std::get<FibreValues>(values.aim.kinds).ray_count = 20;
  return values;
}

/// Beams of two sides through a box, and rays whose directions behind it are told.
LossCase box(std::unique_ptr<Goal> goal, bool reads_directions) {
  const BoxForm form{Vec3::Zero(), 1, 8};
  std::vector<DesignRay> rays;
  std::vector<ScreenReading> screens;
  std::vector<DirectionReading> directions;
  for (const Vec3& along : {Vec3(0, 0, 1), Vec3(1, 0, 0)})
    for (int i = 0; i < 20; ++i) {
      const Frame frame = frame_across(along);
      const Eigen::Vector2d across(0.4 * std::sin(i), 0.4 * std::cos(3 * i));
      rays.push_back({frame * across - 0.9 * along, along, *hull_of(form)});
      screens.push_back({4 * along, along, frame});
      directions.push_back({frame});
    }
  const Readings readings = reads_directions ? Readings(directions) : Readings(screens);
  return {{make_ray_system(rays, readings, {0.1, 1000}), std::move(goal)},
          form,
          some(form.shape().size(), 0.05, 0.05, 3)};
}

Beam beam(int rays) {
  ScreenPicture picture{1.2, 8, {}};
  for (int p = 0; p < 64; ++p) picture.values.push_back(1 + std::sin(p));
  return {shown(picture), Numbers(rays, 1.0 / rays)};
}

}  // namespace

TEST_CASE("The loss of rays that are to meet has its exact derivative") {
  for (const double focus : {0.7, 1.0, 1.8}) {
    check_gradient(case_of(lens("ball", focus), 0.3, 0.05));
    check_gradient(case_of(lens("radial", focus), 0.3, 0.05));
  }
}

namespace {

double farthest(const Numbers& a, const Numbers& b) {
  double most = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(b[i]));
  }
  return most / largest;
}

/// Products with the rows of all rays, which are in single precision, against differences, the
/// gradient and each other.
void check_rows(const LossCase& one, double h) {
  RaySystem& rays = *one.task.rays;
  const std::size_t count = one.at.size(), readings = rays.rays() * rays.readings();
  const Numbers along = some(count, 0, 1, 7), weights = some(readings, 0, 1, 8);
  Numbers before = one.at, after = one.at;
  for (std::size_t i = 0; i < count; ++i) {
    before[i] -= h * along[i];
    after[i] += h * along[i];
  }
  Numbers change = *rays.trace(one.form, after), product(readings), sums(count), normal(count);
  const Numbers less = *rays.trace(one.form, before);
  for (std::size_t i = 0; i < readings; ++i) change[i] = (change[i] - less[i]) / (2 * h);
  rays.trace(one.form, one.at);
  const RayRows rows = rays.linearised();
  rows.times(along, product);
  CHECK(farthest(product, change) < 1e-6);
  rows.normal(along, normal);
  rows.transposed(product, sums);
  CHECK(farthest(normal, sums) < 1e-13);
  rows.transposed(weights, sums);
  CHECK(farthest(sums, rays.gradient(weights)) < 1e-6);
  Numbers squares(count), unit(count, 0.0), column(readings);
  rows.squares(Numbers(readings, 2.0), squares);
  unit[count / 2] = 1;
  rows.times(unit, column);
  double square = 0;
  for (const double c : column) square += 4 * c * c;
  CHECK(squares[count / 2] == doctest::Approx(square));
}

}  // namespace

TEST_CASE("Rows of rays multiply as derivatives do") {
  check_rows(case_of(lens("ball", 1.8), 0.3, 0.05), 1e-4);
  check_rows(case_of(lens("radial", 0.7), 0.3, 0.05), 1e-4);
  check_rows(case_of(fibre(8), 0, 0.05), 1e-4);
  check_rows(case_of(fibre(0), 1.9, 0.05), 1e-4);
}

TEST_CASE(
    "The loss of light of points has its exact derivative, to leave parallel or to pass through an "
    "aperture") {
  DesignValues values;
  values.form.nodes = {6};
  const auto light = [](SourceValues& of) {
    of.sources = {0, 0, -1, 1.2, 0.3, 0};
    of.half_angle = 0.4;
    of.rays_per_source = 9;
  };
  light(std::get<CollimationValues>(values.aim.kinds));
  values.aim.goal = CollimationValues::word;
  check_gradient(case_of(values, 0.3, 0.05));
  values.aim.kinds = {};
  auto& through = std::get<ThroughputValues>(values.aim.kinds);
  light(through);
  through.aperture_radius = 0.1;
  values.aim.goal = ThroughputValues::word;
  check_gradient(case_of(values, 0.3, 0.05));
}

TEST_CASE("The same of rays of a fibre") {
  LossCase profile = case_of(fibre(8), 0, 0.05), power = case_of(fibre(0), 1.9, 0.05);
  profile.difference = power.difference = 3e-3;
  check_gradient(profile);
  check_gradient(power);
}

TEST_CASE("The same of pictures and of deflections, in a box") {
  std::vector<Beam> beams;
  for (int view = 0; view < 2; ++view) beams.push_back(beam(20));
  // the light of pictures has jumps in its third derivative
  LossCase pictures = box(make_picture_goal(beams), false);
  pictures.difference = 1e-4;
  check_gradient(pictures);
  LossCase deflections = box(make_target_goal(some(80, 0, 0.01, 5)), true);
  deflections.difference = 5e-4;
  check_gradient(deflections);
}

}  // namespace flatspeckle::grin::design::test_goals
