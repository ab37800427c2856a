// Compares exact solutions in space with the tables of data/reference/space (sources: its README),
// and with the identities that they must satisfy.

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/numbers/random.h"
#include "reference.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/maps/space_map.h"
#include "wave_solver/solutions/space_checks.h"
#include "wave_solver/solutions/space_solution.h"
#include "wave_solver/spheres/incident_waves.h"
#include "wave_solver/spheres/sphere_pairs.h"

namespace flatspeckle::wave::test_space_solution {

namespace {

using Kind = Scatterer::Kind;

Vec vector_of(const Table& table, std::size_t row) {
  return {table.column("x")[row], table.column("z")[row], table.column("y")[row]};
}

Light wave_along(Vec w) {
  return plane_wave(std::atan2(std::hypot(w.x, w.y), w.z), std::atan2(w.y, w.x));
}
View view_along(Vec w) {
  return far_view(std::atan2(std::hypot(w.x, w.y), w.z), std::atan2(w.y, w.x));
}

/// A placement of the tables with its lights, the views of each light, and their fields.
struct Case {
  Placement placement;
  Lights lights;
  std::vector<View> views;
  std::vector<std::size_t> light_of_view;
  std::vector<Complex> field;

  std::vector<Vec> sensors() const {
    std::vector<Vec> points;
    for (const View& view : views)
      if (view.near) points.push_back(view.point);
    return points;
  }
};

std::vector<Case> cases(const std::string& name) {
  std::map<std::size_t, Case> found;
  const auto number = [](const Table& table, std::size_t row) {
    return static_cast<std::size_t>(table.column("case")[row]);
  };
  const Table placements = read_csv(reference_path("space/" + name + "_placements.csv")),
              lights = read_csv(reference_path("space/" + name + "_lights.csv")),
              fields = read_csv(reference_path("space/" + name + "_fields.csv"));
  for (std::size_t row = 0; row < placements.rows(); ++row) {
    const auto cell = [&](const char* column) { return placements.column(column)[row]; };
    constexpr Kind kinds[] = {Kind::soft, Kind::hard, Kind::tm, Kind::point};
    const Scatterer scatterer{.kind = kinds[static_cast<int>(cell("kind"))],
                              .radius = cell("radius"),
                              .index = {cell("index_re"), cell("index_im")},
                              .albedo = cell("kind") == 3 ? -cell("t0") : 1};
    found[number(placements, row)].placement.push_back({vector_of(placements, row), scatterer});
  }
  for (std::size_t row = 0; row < lights.rows(); ++row) {
    const Vec at = vector_of(lights, row);
    found[number(lights, row)].lights.push_back(lights.column("source")[row] == 1 ? point_source(at)
                                                                                  : wave_along(at));
  }
  for (std::size_t row = 0; row < fields.rows(); ++row) {
    Case& own = found[number(fields, row)];
    const Vec at = vector_of(fields, row);
    own.views.push_back(fields.column("near")[row] == 1 ? near_sensor(at) : view_along(at));
    own.light_of_view.push_back(static_cast<std::size_t>(fields.column("light")[row]));
    own.field.emplace_back(fields.column("re")[row], fields.column("im")[row]);
  }
  std::vector<Case> list;
  for (auto& [index, one] : found) list.push_back(std::move(one));
  return list;
}

/// Returns the largest errors of far and near fields, relative to the largest of each.
double error_of(const Case& one, double tolerance) {
  const auto solution =
      solve_in_space(one.placement, two_pi, one.lights,
                     {.tolerance = tolerance, .sensors = one.sensors(), .diagnose = false});
  const auto fields = solution.fields(one.views);
  double error[2] = {0, 0}, largest[2] = {0, 0};
  for (std::size_t v = 0; v < one.views.size(); ++v) {
    const bool near = one.views[v].near;
    error[near] = std::max(
        error[near], std::abs(fields[one.light_of_view[v] * one.views.size() + v] - one.field[v]));
    largest[near] = std::max(largest[near], std::abs(one.field[v]));
  }
  return std::max(error[0] / largest[0], error[1] / largest[1]);
}

/// Returns three touching-free spheres of different kinds and radii, and a point.
Placement mixed_cluster() {
  return {{{0.1, 0.2, -0.15}, {.kind = Kind::soft, .radius = 0.14}},
          {{-0.3, 0.35, 0.1}, {.kind = Kind::tm, .radius = 0.2, .index = {1.5, 0.1}}},
          {{0.2, 0.7, 0.2}, {.kind = Kind::hard, .radius = 0.17}},
          {{-0.1, 0.8, -0.3}, {.albedo = 0.8}}};
}

Vec turned(Vec a) {  // rotation by 0.7 about z, then by 1.1 about y
  const Vec b{std::cos(0.7) * a.x - std::sin(0.7) * a.y, a.z,
              std::sin(0.7) * a.x + std::cos(0.7) * a.y};
  return {std::cos(1.1) * b.x + std::sin(1.1) * b.z, std::cos(1.1) * b.z - std::sin(1.1) * b.x,
          b.y};
}

Complex amplitude_of(const Placement& placement, Vec light, Vec view, double tolerance) {
  const View seen = view_along(view);
  return solve_in_space(placement, two_pi, {wave_along(light)},
                        {.tolerance = tolerance, .sensors = {}, .diagnose = false})
      .fields({&seen, 1})[0];
}

const Vec first = direction(0.4, 0.9), second = direction(2.2, -0.5);

}  // namespace

TEST_CASE("space solution: reference fields of points") {
  for (const Case& one : cases("points")) CHECK(error_of(one, 1e-11) < 1e-12);
}

TEST_CASE("space solution: reference fields of spheres at each tolerance") {
  std::ostringstream line;
  std::size_t number = 0;
  for (const Case& one : cases("spheres")) {
    CAPTURE(number);
    line << "\ncase " << number++ << ", error / tolerance:";
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-11}) {
      CAPTURE(tolerance);
      const double error = error_of(one, tolerance);
      line << ' ' << error / tolerance;
      CHECK(error < 10 * tolerance);
    }
  }
  MESSAGE(line.str());
}

TEST_CASE("space solution: energy, boundary conditions and residual of mixed spheres") {
  const auto solution =
      solve_in_space(mixed_cluster(), two_pi, {wave_along(first), wave_along(second)},
                     {.tolerance = 1e-12, .sensors = {}});
  const Diagnosis& diagnosis = solution.diagnosis();
  MESSAGE("orders " << solution.equations().order(0) << ' ' << solution.equations().order(1)
                    << ", power " << diagnosis.power.off << ", boundary "
                    << diagnosis.boundary_residual << ", residual " << diagnosis.residual);
  CHECK(diagnosis.power.holds());
  CHECK(diagnosis.power.off < 1e-11);
  CHECK(diagnosis.residual < 1e-13);
  CHECK(diagnosis.condition > 1);
  CHECK(diagnosis.boundary_residual > 0);
  Placement lossless = mixed_cluster();
  lossless[1].scatterer.index = 1.5;
  lossless[3].scatterer = {.phase_shift = 0.9};
  const auto without = solve_in_space(lossless, two_pi, {wave_along(first)},
                                      {.tolerance = 1e-9, .sensors = {}, .diagnose = false});
  const View forward = view_along(first);
  CHECK(std::abs(2 * without.fields({&forward, 1})[0].imag() - power_of_waves(without, 0)) < 1e-13);
}

TEST_CASE("space solution: boundary conditions of three mixed spheres at high orders") {
  const auto three = cases("spheres")[9];
  BasisOrders orders(two_pi, 1e-12, sphere_rules());
  SphereEquations equations(three.placement, two_pi, orders.basis(three.placement, {}, 1.4));
  auto beta = DenseFactor(equations.matrix(), equations.unknowns())
                  .solve(equations.right_hand_sides(three.lights, 1e-12));
  const SpaceSolution solution(std::move(equations), three.lights, std::move(beta));
  CHECK(boundary_residual(solution, 1e-12) < 1e-9);
}

TEST_CASE("space solution: reciprocity, rotation and translation of a placement") {
  constexpr double tolerance = 1e-13;
  const Placement cluster = mixed_cluster();
  const Complex there = amplitude_of(cluster, first, second, tolerance);
  CHECK(std::abs(there - amplitude_of(cluster, -second, -first, tolerance)) <
        1e-11 * std::abs(there));
  Placement moved = cluster, shifted = cluster;
  for (auto& placed : moved) placed.position = turned(placed.position);
  CHECK(std::abs(there - amplitude_of(moved, turned(first), turned(second), tolerance)) <
        1e-11 * std::abs(there));
  const Vec shift{0.3, -2.1, 1.4};
  for (auto& placed : shifted) placed.position = placed.position + shift;
  const Complex phase = std::polar(1.0, two_pi * dot(first - second, shift));
  CHECK(std::abs(there * phase - amplitude_of(shifted, first, second, tolerance)) <
        1e-11 * std::abs(there));
  const Vec point{1.2, 1.9, -0.8};
  const View far = view_along(-first), near = near_sensor(point);
  const SolveOptions options{.tolerance = tolerance, .sensors = {point}, .diagnose = false};
  const Complex
      from = solve_in_space(cluster, two_pi, {point_source(point)}, options).fields({&far, 1})[0],
      to = solve_in_space(cluster, two_pi, {wave_along(first)}, options).fields({&near, 1})[0];
  CHECK(std::abs(to - 4 * std::numbers::pi * from) < 1e-11 * std::abs(to));
}

TEST_CASE("space solution: the iterative method agrees with the dense one") {
  Placement points(400), spheres = mixed_cluster();
  RandomStream random(2, 0, 0);
  for (auto& placed : points)
    placed.position = {4 * random.uniform(), 3 * random.uniform(), 4 * random.uniform()};
  const std::vector<View> views{view_along(second), view_along(-first)};
  for (const Placement& placement : {points, spheres}) {
    const auto fields = [&](Method method) {
      return solve_in_space(placement, two_pi, {wave_along(first), wave_along(second)},
                            {.tolerance = 1e-9, .sensors = {}, .diagnose = true, .method = method})
          .fields(views);
    };
    const auto dense = fields(Method::dense), krylov = fields(Method::krylov);
    CHECK(relative_distance(krylov, dense) < 1e-8);
  }
  CHECK_THROWS_AS(solve_in_space(points, two_pi, {0.0}, {.method = Method::fast}), InputError);
}

TEST_CASE("space solution: a Gaussian beam has its field at and beside the focus") {
  const Light beam = gaussian_beam(0.3, {0.2, 1, -0.4}, 1.5, 0.8);
  const Vec axis = beam.direction(), aside = cross(axis, Vec{0, 1}),
            across = (1 / length(aside)) * aside;
  for (const double distance : {0.0, 0.7, 1.5}) {
    const Vec at = beam.point + distance * across;
    Complex sum = 0;
    for (const auto& [w, weight] : beam_waves(beam, two_pi, 6, 1e-10))
      sum += weight * std::polar(1.0, two_pi * dot(w, at));
    CHECK(std::abs(sum - std::exp(-distance * distance / 2.25)) < 3e-3);
    CHECK(std::abs(sum.imag()) < 1e-10);
  }
  // A weak point scatters the field of the beam at its place.
  const Vec place{1.2, 2.5, 0.3};
  const Placement point{{place, {.phase_shift = 0.01}}};
  const auto scattered = [&](const Light& light) {
    const View view = view_along(second);
    return solve_in_space(point, two_pi, {light}, {.tolerance = 1e-10, .sensors = {}})
        .fields({&view, 1})[0];
  };
  Complex expected = 0;
  for (const auto& [w, weight] : beam_waves(beam, two_pi, 20, 1e-10))
    expected += weight * std::polar(1.0, two_pi * dot(w, place));
  const Complex unit = scattered(wave_along(first)) * std::polar(1.0, -two_pi * dot(first, place));
  CHECK(std::abs(scattered(beam) - expected * unit) < 1e-9 * std::abs(unit));
}

TEST_CASE("space solution: the total field of a map is continuous through penetrable spheres") {
  Placement cluster = mixed_cluster();
  cluster.push_back({{-0.9, 0.2, 0.6}, {.kind = Kind::tm, .radius = 0.25, .index = 1.8}});
  const double rim = 1e-6;
  std::vector<Vec> points;
  for (const std::size_t sphere : {1, 4})
    for (const Vec& n : {first, second, Vec{0, 1}}) {
      const auto& [centre, scatterer] = cluster[sphere];
      for (const double side : {-rim, rim})
        points.push_back(centre + (scatterer.radius + side) * n);
    }
  const auto solution =
      solve_in_space(cluster, two_pi, {wave_along(first), point_source({2, -1, 1})},
                     {.tolerance = 1e-8, .sensors = points});
  const auto field = total_field(solution, points, 1e-8);
  for (std::size_t i = 0; i < field.size(); i += 2)
    CHECK(std::abs(field[i] - field[i + 1]) < 1e-4 * std::abs(field[i]));
  // Inside, u obeys the Helmholtz equation of index m: its mean over a small sphere is
  // u j_0(m k h), h the radius; by differences along the axes, to the order h^4.
  const Vec at = cluster[4].position + Vec{0.06, -0.03, 0.08};
  const double h = 0.01;
  std::vector<Vec> star{at};
  for (const Vec& step : {Vec{h, 0}, Vec{0, h}, Vec{0, 0, h}})
    for (const double sign : {-1.0, 1.0}) star.push_back(at + sign * step);
  const auto u = total_field(solution, star, 1e-8);
  Complex laplacian = -6.0 * u[0];
  for (std::size_t i = 1; i < 7; ++i) laplacian += u[i];
  const double expected = -std::pow(1.8 * two_pi * h, 2);
  CHECK(std::abs(laplacian / u[0] - expected) < 2e-3 * std::abs(expected));
  // Outside, the map is the light plus the scattered field; in hard spheres it is 0.
  const Vec outside{0.7, 1.4, 0.4}, solid = cluster[2].position;
  const View view = near_sensor(outside);
  const auto scattered = solution.fields({&view, 1});
  const auto pair = total_field(solution, std::vector{outside, solid}, 1e-8);
  CHECK(std::abs(pair[0] - std::polar(1.0, two_pi * dot(first, outside)) - scattered[0]) < 1e-12);
  CHECK(pair[1] == Complex(0));
}

TEST_CASE("space solution: tiny spheres, whose waves overflow double, are points") {
  const double radius = 1e-4 / two_pi, gap = 0.5 * radius;
  const Scatterer tiny{.kind = Kind::soft, .radius = radius};
  const Placement pair{{{0, 0.3}, tiny}, {{2 * radius + gap, 0.3, 0.1 * radius}, tiny}};
  const auto solution = solve_in_space(pair, two_pi, {0.4}, {.tolerance = 1e-10, .sensors = {}});
  CHECK(solution.diagnosis().power.off < 1e-9);
  CHECK(solution.diagnosis().boundary_residual < 1e-4);
}

TEST_CASE("space solution: no scatterers, transparent spheres and overlaps") {
  const View view = view_along(second);
  CHECK(solve_in_space({}, two_pi, {0.2}).fields({&view, 1})[0] == Complex(0));
  CHECK(solve_in_space({}, two_pi, {0.2}).diagnosis().residual == 0);
  Placement clear{{{0, 0}, {.kind = Kind::tm, .radius = 0.2, .index = 1}}};
  CHECK(solve_in_space(clear, two_pi, {0.2}).fields({&view, 1})[0] == Complex(0));
  clear.push_back({{0, 0.1, 0.3}, {.kind = Kind::soft, .radius = 0.2}});
  CHECK_THROWS_AS(solve_in_space(clear, two_pi, {0.2}), InputError);

  CHECK_THROWS_AS(solve_in_space({{{0, 0}, {.kind = Kind::hard, .radius = 0.2}},
                                  {{0, 0, 0.4000001}, {.kind = Kind::hard, .radius = 0.2}}},
                                 two_pi, {0.2}),
                  InputError);
  const View inside = near_sensor({0.1, 0});
  CHECK_THROWS_AS(solve_in_space({clear[0]}, two_pi, {0.2}).fields({&inside, 1}), InputError);
}

}  // namespace flatspeckle::wave::test_space_solution
