#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/design/adjoint/design_ray.h"
#include "grin/design/adjoint/measurement.h"
#include "grin/design/forms/field_form.h"

namespace flatspeckle::grin::design::test_ray_adjoint {

namespace {

using Numbers = std::vector<double>;

/// Returns random numbers between -size and size.
Numbers random_numbers(std::size_t count, double size, std::uint64_t stream) {
  RandomStream random(1, stream, 0);
  Numbers values(count);
  for (double& v : values) v = size * (2 * random.uniform() - 1);
  return values;
}
Numbers sum(const Numbers& a, double factor, const Numbers& b) {
  Numbers values = a;
  for (std::size_t i = 0; i < a.size(); ++i) values[i] += factor * b[i];
  return values;
}

/// A grid without a rim, as a form.
struct GridForm {
  FieldGrid grid{{-1.1, -1.2, -1.3}, {0.4, 0.45, 0.5}, {7, 6, 6}};

  SplineField field(const Numbers& values) const {
    return SplineField::of_coefficients(grid, values);
  }
  CoefficientShape shape() const { return {{9, 8, 8}}; }
};

const DesignRay into_ball{Vec3(0.3, -0.4, -std::sqrt(0.75)), Vec3::UnitZ(), Sphere{}};
const DesignRay in_grid{Vec3(0.3, -0.4, -0.9), Vec3(0.2, 0.1, 1),
                        Plane{{0, 0, 0.9}, Vec3::UnitZ()}};
const Frame across = frame_across(Vec3(0.1, 0.2, 1));

/// One ray in one kind of field, and one kind of measurement.
template <class Form, class Measure>
struct RayCase {
  static constexpr int K = Measure::count;
  Form form;
  DesignRay ray;
  Measure measure;
  RayWalk walk{0.07, 1000};
  double difference = 2e-4;
  Numbers coefficients =
      sum(Numbers(form.shape().size(), 0.2), 1, random_numbers(form.shape().size(), 0.05, 1));

  Eigen::Matrix<double, K, 1> values(const Numbers& at) const {
    return measure(follow<Pefrl>(form.field(at), ray, walk).state).values;
  }
  /// Returns the derivatives of each measured value by all coefficients.
  std::array<Numbers, K> gradient(RayState* again = nullptr) const {
    const auto field = form.field(coefficients);
    const FollowedRay followed = follow<Pefrl>(field, ray, walk);
    CHECK(!followed.lost);
    CoefficientSums<K> sums(shape_of(field));
    const RayState start =
        backpropagate<Pefrl>(field, ray, walk, followed, measure(followed.state).by, sums);
    if (again) *again = start;
    std::array<Numbers, K> rows;
    rows.fill(Numbers(form.shape().size(), 0.0));
    sums.take([&](std::size_t number, const std::array<double, K>& derivatives) {
      for (int k = 0; k < K; ++k) rows[k][number] = derivatives[k];
    });
    return rows;
  }
  /// Returns the derivatives along a vector by differences, extrapolated twice.
  Eigen::Matrix<double, K, 1> differences(const Numbers& along, double h) const {
    const auto central = [&](double step) {
      return ((values(sum(coefficients, step, along)) - values(sum(coefficients, -step, along))) /
              (2 * step))
          .eval();
    };
    const auto d0 = central(h), d1 = central(h / 2), d2 = central(h / 4);
    const auto e0 = ((4 * d1 - d0) / 3).eval(), e1 = ((4 * d2 - d1) / 3).eval();
    return (16 * e1 - e0) / 15;
  }
};

double dot(const Numbers& a, const Numbers& b) {
  double value = 0;
  for (std::size_t i = 0; i < a.size(); ++i) value += a[i] * b[i];
  return value;
}

template <class Form, class Measure>
void check_direction(const RayCase<Form, Measure>& ray) {
  const auto rows = ray.gradient();
  const Numbers along = random_numbers(ray.coefficients.size(), 1, 2);
  const auto expected = ray.differences(along, ray.difference);
  for (int k = 0; k < ray.K; ++k) {
    CHECK(std::abs(dot(rows[k], along) - expected[k]) < 1e-8 * std::abs(expected[k]));
    const auto rest = [&](double h) {
      return ray.values(sum(ray.coefficients, h, along))[k] - ray.values(ray.coefficients)[k] -
             h * dot(rows[k], along);
    };
    // without the cubic term, beside which the quadratic one is small along some directions
    const auto square = [&](double h) { return 8 * rest(h / 2) - rest(h); };
    const double h = 0.8 * ray.difference, order = std::log2(std::abs(square(h) / square(h / 2)));
    CHECK(order > 1.98);
    CHECK(order < 2.02);
  }
}

template <class Form, class Measure>
void check_components(const RayCase<Form, Measure>& ray) {
  const auto rows = ray.gradient();
  const std::size_t count = ray.coefficients.size(), every = std::max<std::size_t>(1, count / 200);
  for (int k = 0; k < ray.K; ++k) {
    const double largest =
        std::abs(*std::max_element(rows[k].begin(), rows[k].end(),
                                   [](double a, double b) { return std::abs(a) < std::abs(b); }));
    CHECK(largest > 1e-3);
    double worst = 0;
    for (std::size_t i = 0; i < count; i += every) {
      Numbers along(count, 0.0);
      along[i] = 1;
      worst = std::max(worst, std::abs(ray.differences(along, ray.difference)[k] - rows[k][i]));
    }
    CHECK(worst < 1e-8 * largest);
  }
}

template <class Form, class Measure>
void check_derivatives(const Form& form, const DesignRay& ray, const Measure& measure) {
  const RayCase<Form, Measure> one{form, ray, measure};
  check_direction(one);
  check_components(one);
}

template <class Form>
void check_measurements(const Form& form, const DesignRay& ray) {
  check_derivatives(form, ray,
                    ScreenMeasurement{{0.1, 0.2, 2}, Vec3::UnitZ(), frame_across(Vec3::UnitZ())});
  check_derivatives(form, ray, SurfaceMeasurement{{0, 0, 1}, across});
  check_derivatives(form, ray, DirectionMeasurement{across});
  check_derivatives(form, ray, PathMeasurement{});
}

}  // namespace

TEST_CASE(
    "measurements of a ray: derivatives by the coefficients of a ball agree with differences") {
  check_measurements(BallForm{Vec3::Zero(), 1, 6}, into_ball);
}
TEST_CASE(
    "measurements of a ray: derivatives by the coefficients of a radial spline agree with "
    "differences") {
  check_measurements(RadialForm{Vec3::Zero(), 1, 8}, into_ball);
}
TEST_CASE("measurements of a ray that starts in a grid: derivatives agree with differences") {
  check_measurements(GridForm{}, in_grid);
}
TEST_CASE("measurements of a ray that ends inside a ball: derivatives agree with differences") {
  const DesignRay ray{into_ball.start, into_ball.direction, Plane{{0, 0, 0.4}, Vec3::UnitZ()}};
  check_derivatives(BallForm{Vec3::Zero(), 1, 6}, ray, SurfaceMeasurement{{0, 0, 0.4}, across});
}

TEST_CASE(
    "measurements of fibre rays that end nearest to the axis: derivatives agree with differences") {
  const GuideForm profile{{0.47, 0.05, 1}, 8}, power{{0.47, 0.05, 1}, 0};
  const DesignRay skew{Vec3(0.7, 0, 0), Vec3(0, 0.12, 1), Turn{Vec3::Zero()}};
  const DesignRay meridional{Vec3(0.8, 0, 0), Vec3::UnitZ(), Turn{Vec3::Zero()}};
  for (const DesignRay& ray : {skew, meridional}) {
    // derivatives are small beside the value, whose rounding would dominate shorter differences
    RayCase<GuideForm, PathPerLengthMeasurement> correction{profile, ray, {0}};
    correction.difference = 2e-3;
    check_direction(correction);
    check_components(correction);
    RayCase<GuideForm, PathPerLengthMeasurement> exponent{power, ray, {0}};
    exponent.coefficients = {1.9};
    exponent.difference = 5e-3;
    check_direction(exponent);
  }
}

TEST_CASE("backpropagation: the reversed ray returns to its start") {
  const RayCase<BallForm, SurfaceMeasurement> ray{
      {Vec3::Zero(), 1, 9}, into_ball, {{0, 0, 1}, across}};
  RayState again;
  ray.gradient(&again);
  CHECK((again.x - into_ball.start).norm() < 1e-12);
  CHECK((again.v - into_ball.direction).norm() < 1e-12);
  CHECK(std::abs(again.optical_path) < 1e-12);
}

TEST_CASE("knot insertion: the field is unchanged") {
  const BallForm form{Vec3(0.1, 0, 0.2), 1.5, 5};
  const Numbers values = random_numbers(form.shape().size(), 0.2, 3);
  const FinerField fine = finer(form, values);
  const auto before = form.field(values);
  const auto after = std::get<BallForm>(fine.form).field(fine.coefficients);
  for (int i = 0; i < 50; ++i) {
    const Vec3 x(std::sin(i), std::cos(3 * i), std::sin(2 * i + 1));
    CHECK(std::abs(before.excess(x) - after.excess(x)) < 1e-15);
  }
  const RadialForm cubic{Vec3::Zero(), 1, 4, 8};
  const FinerField cells = finer(cubic, values);
  for (int i = 0; i < 20; ++i) {
    const Vec3 x(0, 0.05 * i, 0);
    CHECK(std::abs(cubic.field(std::span(values).first(4)).excess(x) -
                   std::get<RadialForm>(cells.form).field(cells.coefficients).excess(x)) < 1e-15);
  }
}

}  // namespace flatspeckle::grin::design::test_ray_adjoint
