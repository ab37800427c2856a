#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "reference.h"
#include "wave_solver/solutions/equation_solver.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_light_basis {

namespace {

std::vector<double> fan(double first, double last, int lights) {
  std::vector<double> angles;
  for (int i = 0; i < lights; ++i) angles.push_back(first + (last - first) * i / lights);
  return angles;
}

constexpr Circle circle{{0.7, -2}, 1.5};

// Returns the largest error of the combinations over points in the circle.
double worst_error(const std::vector<double>& angles, const LightBasis& basis) {
  double worst = 0;
  const std::size_t rank = basis.angles.size();
  for (std::size_t light = 0; light < angles.size(); ++light)
    for (int i = 0; i < 40; ++i) {
      const Vec point = circle.centre + circle.radius * (i % 10 / 9.0) * direction(i);
      Complex sum = 0;
      for (std::size_t j = 0; j < rank; ++j)
        sum += basis.weights[light * rank + j] *
               std::polar(1.0, two_pi * dot(direction(basis.angles[j]), point));
      const Complex wave = std::polar(1.0, two_pi * dot(direction(angles[light]), point));
      worst = std::max(worst, std::abs(sum - wave));
    }
  return worst;
}

}  // namespace

TEST_CASE("light basis: many lights are combinations of few within the tolerance") {
  for (const double tolerance : {1e-3, 1e-6, 1e-12}) {
    const auto around = fan(0, two_pi, 200), narrow = fan(0.2, 0.4, 33);
    const auto all = light_basis(around, two_pi, circle, tolerance);
    const auto some = light_basis(narrow, two_pi, circle, tolerance);
    CAPTURE(tolerance);
    CHECK(all.count() == 200);
    CHECK(all.angles.size() > 2 * two_pi * circle.radius);
    CHECK(all.angles.size() < 2 * two_pi * circle.radius + 50);
    CHECK(some.angles.size() < 16);
    CHECK(worst_error(around, all) < 10 * tolerance);
    CHECK(worst_error(narrow, some) < 10 * tolerance);
  }
}

TEST_CASE("light basis: lights that cannot be compressed are unchanged") {
  const auto angles = fan(0, two_pi, 20);
  const auto basis = light_basis(angles, two_pi, circle, 1e-6);
  CHECK(basis.angles == angles);
  CHECK(basis.weights.empty());
  CHECK(light_basis(fan(0, 0.1, 3), two_pi, circle, 1e-6).weights.empty());
}

TEST_CASE("field plan: compressed lights and views agree with single solutions") {
  const Placement placement = reference_placement("g10", "TE15");
  const SolveOptions options{.tolerance = 1e-12, .sensors = {}, .diagnose = false};
  const Circle around = enclosing_circle(placement);
  for (const auto& [lights, views] :
       {std::pair{120, 40}, std::pair{30, 300}, std::pair{200, 200}}) {
    const auto angles = fan(-1, 1, lights);
    std::vector<View> sensors;
    for (double angle : fan(0, two_pi, views)) sensors.push_back(far_view(angle));
    // One solution per light, evaluated at all views.
    std::vector<Complex> one_by_one;
    for (double angle : angles) {
      const auto fields = solve(placement, two_pi, {angle}, options).fields(sensors);
      one_by_one.insert(one_by_one.end(), fields.begin(), fields.end());
      if (one_by_one.size() > 2000) break;
    }
    const auto plan = make_field_plan(angles, sensors, two_pi, around, 1e-12);
    auto fields = scattered_fields(placement, two_pi, plan, options);
    CHECK(fields.size() == angles.size() * sensors.size());
    fields.resize(one_by_one.size());
    CHECK(relative_distance(fields, one_by_one) < 1e-11);
  }
}

TEST_CASE("enclosing circle: contains all rims") {
  const Placement placement = reference_placement("g10", "D");
  const Circle around = enclosing_circle(placement);
  for (const auto& [position, disk] : placement)
    CHECK(length(position - around.centre) + disk.radius <= around.radius * (1 + 1e-15));
  CHECK(enclosing_circle({}).radius == 0);
}

TEST_CASE(
    "Gaussian beam: the superposition of plane waves agrees with its field across the focus") {
  const Circle box{{1, 5}, 11};
  const double waist = 2;
  const Lights lights = {gaussian_beam(0.3, {0.5, 2}, waist), gaussian_beam(0.3, {-1, 2}, waist),
                         plane_wave(1)};
  const auto basis = basis_of(lights, two_pi, box, 1e-8);
  REQUIRE(basis.count() == 3);
  CHECK(basis.sources.empty());
  const auto field = [&](std::size_t light, Vec point) {
    Complex sum = 0;
    for (std::size_t j = 0; j < basis.size(); ++j)
      sum += basis.weights[light * basis.size() + j] *
             std::polar(1.0, two_pi * dot(direction(basis.angles[j]), point));
    return sum;
  };
  const Vec across{std::cos(0.3), -std::sin(0.3)};
  for (const double t : {-7.0, -2.0, 0.0, 1.0, 6.0}) {
    const double expected = std::exp(-t * t / (waist * waist));
    CHECK(std::abs(field(0, lights[0].point + t * across) - expected) < 1e-7);
    CHECK(std::abs(field(1, lights[1].point + t * across) - expected) < 1e-7);
    const Vec point{t, 5};
    CHECK(std::abs(field(2, point) - std::polar(1.0, two_pi * dot(direction(1), point))) < 1e-6);
  }
}

TEST_CASE("point sources: reciprocal to near sensors, and to plane waves in the far field") {
  const Placement placement = reference_placement("g1", "TM15");
  const Circle around = enclosing_circle(placement);
  const SolveOptions options{.tolerance = 1e-10, .sensors = {}, .diagnose = false};
  const auto fields_of = [&](const Lights& lights, const std::vector<View>& views) {
    return scattered_fields(placement, two_pi,
                            make_field_plan(lights, views, two_pi, around, 1e-10), options);
  };
  const Vec here = around.centre + (around.radius + 2) * direction(0.7),
            there = around.centre + (around.radius + 1) * direction(-2.0);
  const Complex forth = fields_of({point_source(here)}, {near_sensor(there)})[0],
                back = fields_of({point_source(there)}, {near_sensor(here)})[0];
  CHECK(std::abs(forth) > 1e-4);
  CHECK(std::abs(forth - back) < 1e-9);
  // The far field towards v of a source at x equals the near field at x of the light from v, times
  // e^(i pi/4) / sqrt(8 pi k).
  const Complex scale =
      std::polar(1 / std::sqrt(8 * std::acos(-1.0) * two_pi), std::acos(-1.0) / 4);
  const Complex far = fields_of({point_source(here)}, {far_view(0.4)})[0],
                near = fields_of({plane_wave(0.4 + std::acos(-1.0))}, {near_sensor(here)})[0];
  CHECK(std::abs(far - scale * near) < 1e-9);
  CHECK_THROWS_AS(basis_of({point_source(here), plane_wave(0)}, two_pi, around, 1e-6), InputError);
}

}  // namespace flatspeckle::wave::test_light_basis
