#include <cmath>
#include <fstream>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/design/adjoint/measurement.h"
#include "grin/design/objectives/screen_target.h"
#include "grin/design/problem/design_scene.h"

namespace flatspeckle::grin::design::test_objectives {

namespace {

using Numbers = std::vector<double>;

Numbers random_numbers(std::size_t count, double middle, double size, std::uint64_t stream) {
  RandomStream random(1, stream, 0);
  Numbers values(count);
  for (double& v : values) v = middle + size * (2 * random.uniform() - 1);
  return values;
}

/// Loss of a task. Its derivatives are checked against differences: along all coefficients at once
/// to 1e-8, by some of them to 1e-8 of the largest.
struct LossCase {
  DesignTask task;
  FieldForm form;
  Numbers at;
  double difference = 2e-3;

  Objective objective() const { return {*task.rays, *task.objective, form}; }
  double moved(const Numbers& along, double by) const {
    Numbers values = at;
    for (std::size_t i = 0; i < at.size(); ++i) values[i] += by * along[i];
    return objective().loss(values);
  }
  /// Returns the derivative along a vector by differences, extrapolated twice.
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
  const Numbers along = random_numbers(count, 0, 1, 7);
  double derivative = 0, largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    derivative += gradient[i] * along[i];
    largest = std::max(largest, std::abs(gradient[i]));
  }
  CHECK(std::abs(derivative / one.by_differences(along) - 1) < 1e-8);
  for (std::size_t i = 0; i < count; i += std::max<std::size_t>(1, count / 20)) {
    Numbers unit(count, 0.0);
    unit[i] = 1;
    CHECK(std::abs(one.by_differences(unit) - gradient[i]) < 1e-8 * largest);
  }
}

LossCase case_of(const DesignValues& values, double middle, double size) {
  const DesignScene scene = make_design_scene(values);
  return {scene.design_target->task(scene.walk, false), scene.start.form,
          random_numbers(shape_of(scene.start.form).size(), middle, size, 3)};
}

DesignValues lens(const char* design, double focus) {
  DesignValues values;
  values.form.design = design;
  if (values.form.design == "ball") values.form.nodes = {6};
  auto& light = std::get<FocusValues>(values.design_target.kinds);
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
  values.step = 0.141;  // rays turn within a step; turns at the end of one would cause a kink
  values.design_target.goal = FibreValues::word;
  std::get<FibreValues>(values.design_target.kinds).ray_count = 20;
  return values;
}

/// Returns a case of beams from two sides through a box, measured on screens or by direction.
LossCase box(std::unique_ptr<DesignObjective> design_objective, bool measures_directions) {
  const BoxForm form{Vec3::Zero(), 1, 8};
  std::vector<DesignRay> rays;
  std::vector<ScreenMeasurement> screens;
  std::vector<DirectionMeasurement> directions;
  for (const Vec3& along : {Vec3(0, 0, 1), Vec3(1, 0, 0)})
    for (int i = 0; i < 20; ++i) {
      const Frame frame = frame_across(along);
      const Eigen::Vector2d across(0.4 * std::sin(i), 0.4 * std::cos(3 * i));
      rays.push_back({frame * across - 0.9 * along, along, *hull_of(form)});
      screens.push_back({4 * along, along, frame});
      directions.push_back({frame});
    }
  const Measurements measurements =
      measures_directions ? Measurements(directions) : Measurements(screens);
  return {{make_ray_system(rays, measurements, {0.1, 1000}), std::move(design_objective)},
          form,
          random_numbers(form.shape().size(), 0.05, 0.05, 3)};
}

Beam beam(int rays) {
  ScreenPicture picture{1.2, 8, {}};
  for (int p = 0; p < 64; ++p) picture.values.push_back(1 + std::sin(p));
  return {shown(picture), Numbers(rays, 1.0 / rays)};
}

}  // namespace

TEST_CASE("focusing loss: gradient agrees with differences") {
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

/// Checks products with the Jacobian rows of all rays, which are in single precision, against
/// differences, the gradient and each other.
void check_rows(const LossCase& one, double h) {
  RaySystem& rays = *one.task.rays;
  const std::size_t count = one.at.size(), measurements = rays.rays() * rays.measurements();
  const Numbers along = random_numbers(count, 0, 1, 7),
                weights = random_numbers(measurements, 0, 1, 8);
  Numbers before = one.at, after = one.at;
  for (std::size_t i = 0; i < count; ++i) {
    before[i] -= h * along[i];
    after[i] += h * along[i];
  }
  Numbers change = *rays.trace(one.form, after), product(measurements), sums(count), normal(count);
  const Numbers less = *rays.trace(one.form, before);
  for (std::size_t i = 0; i < measurements; ++i) change[i] = (change[i] - less[i]) / (2 * h);
  rays.trace(one.form, one.at);
  const RayRows rows = rays.linearised();
  rows.times(along, product);
  CHECK(farthest(product, change) < 1e-6);
  rows.normal(along, normal);
  rows.transposed(product, sums);
  CHECK(farthest(normal, sums) < 1e-13);
  rows.transposed(weights, sums);
  CHECK(farthest(sums, rays.gradient(weights)) < 1e-6);
  Numbers squares(count), unit(count, 0.0), column(measurements);
  rows.squares(Numbers(measurements, 2.0), squares);
  unit[count / 2] = 1;
  rows.times(unit, column);
  double square = 0;
  for (const double c : column) square += 4 * c * c;
  CHECK(squares[count / 2] == doctest::Approx(square));
}

}  // namespace

TEST_CASE("Jacobian rows of rays: products agree with differences and the gradient") {
  check_rows(case_of(lens("ball", 1.8), 0.3, 0.05), 1e-4);
  check_rows(case_of(lens("radial", 0.7), 0.3, 0.05), 1e-4);
  check_rows(case_of(fibre(8), 0, 0.05), 1e-4);
  check_rows(case_of(fibre(0), 1.9, 0.05), 1e-4);
}

TEST_CASE("collimation and throughput losses of point sources: gradients agree with differences") {
  DesignValues values;
  values.form.nodes = {6};
  const auto light = [](SourceValues& of) {
    of.sources = {0, 0, -1, 1.2, 0.3, 0};
    of.half_angle = 0.4;
    of.rays_per_source = 9;
  };
  light(std::get<CollimationValues>(values.design_target.kinds));
  values.design_target.goal = CollimationValues::word;
  check_gradient(case_of(values, 0.3, 0.05));
  values.design_target.kinds = {};
  auto& through = std::get<ThroughputValues>(values.design_target.kinds);
  light(through);
  through.aperture_radius = 0.1;
  values.design_target.goal = ThroughputValues::word;
  check_gradient(case_of(values, 0.3, 0.05));
}

TEST_CASE("fibre loss: gradient agrees with differences") {
  LossCase profile = case_of(fibre(8), 0, 0.05), power = case_of(fibre(0), 1.9, 0.05);
  profile.difference = power.difference = 3e-3;
  check_gradient(profile);
  check_gradient(power);
}

TEST_CASE("picture and deflection losses of a box: gradients agree with differences") {
  std::vector<Beam> beams;
  for (int view = 0; view < 2; ++view) beams.push_back(beam(20));
  // the irradiance of pictures has jumps in its third derivative
  LossCase pictures = box(make_picture_objective(beams), false);
  pictures.difference = 1e-4;
  check_gradient(pictures);
  LossCase deflections = box(make_target_objective(random_numbers(80, 0, 0.01, 5)), true);
  deflections.difference = 5e-4;
  check_gradient(deflections);
}

}  // namespace flatspeckle::grin::design::test_objectives
