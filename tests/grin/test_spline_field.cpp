#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <unistd.h>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/result/result_file.h"
#include "grin/media/fields/spline_field.h"
#include "tests/grin/derivatives.h"

namespace flatspeckle::grin::test_spline_field {

namespace {

template <class Function>
std::vector<double> samples(const FieldGrid& grid, const Function& f) {
  std::vector<double> values;
  for (int i = 0; i < grid.nodes[0]; ++i)
    for (int j = 0; j < grid.nodes[1]; ++j)
      for (int k = 0; k < grid.nodes[2]; ++k)
        values.push_back(f((grid.origin + grid.spacing.cwiseProduct(Vec3(i, j, k))).eval()));
  return values;
}

double wavy(const Vec3& x) {
  return 0.1 * std::sin(2 * x[0] + x[1]) * std::cos(x[2] - x[1]);
}

FieldGrid unit_grid(int nodes) {
  const double step = 1.0 / (nodes - 1);
  return {{0, 0, 0}, {step, step, step}, {nodes, nodes, nodes}};
}

double worst_error(int nodes, bool at_the_edge) {
  const SplineField field(unit_grid(nodes), samples(unit_grid(nodes), wavy));
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 x(at_the_edge ? 0.3 / nodes : std::fmod(0.37 * i, 1), std::fmod(0.61 * i, 1),
                 std::fmod(0.73 * i, 1));
    worst = std::max(worst, std::abs(field.excess(x) - wavy(x)));
  }
  return worst;
}

}  // namespace

TEST_CASE("spline field: interpolates its samples, with an error of fourth order up to the edge") {
  const FieldGrid grid{{-1, 2, 0.5}, {0.3, 0.2, 0.1}, {4, 6, 9}};
  const auto values = samples(grid, wavy);
  const SplineField field(grid, values);
  std::size_t n = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 9; ++k)
        CHECK(std::abs(field.excess(grid.origin + grid.spacing.cwiseProduct(Vec3(i, j, k))) -
                       values[n++]) < 1e-15);
  for (const bool edge : {false, true})
    CHECK(std::log2(worst_error(11, edge) / worst_error(21, edge)) ==
          doctest::Approx(4).epsilon(0.1));
}

TEST_CASE("spline field: reproduces cubics and their derivatives") {
  const FieldGrid grid{{-1, -1, -1}, {0.5, 0.4, 0.3}, {5, 6, 8}};
  const auto cubic = [](const Vec3& x) {
    return 0.1 * x[0] * x[0] * x[1] - 0.05 * x[2] * x[2] * x[2] + 0.02 * x[0] * x[1] * x[2] + 0.1;
  };
  const SplineField field(grid, samples(grid, cubic));
  for (int i = 0; i < 50; ++i) {
    const Vec3 x(std::sin(i), 0.9 * std::sin(2 * i + 1), std::cos(3 * i));
    const IndexHessian at = field.hessian(x);
    CHECK(std::abs(at.excess - cubic(x)) < 1e-15);
    const Vec3 gradient(0.2 * x[0] * x[1] + 0.02 * x[1] * x[2],
                        0.1 * x[0] * x[0] + 0.02 * x[0] * x[2],
                        -0.15 * x[2] * x[2] + 0.02 * x[0] * x[1]);
    CHECK((at.gradient - gradient).norm() < 1e-14);
    const double xy = 0.2 * x[0] + 0.02 * x[2], xz = 0.02 * x[1], yz = 0.02 * x[0];
    const Mat3 hessian{{0.2 * x[1], xy, xz}, {xy, 0, yz}, {xz, yz, -0.3 * x[2]}};
    CHECK((at.hessian - hessian).norm() < 1e-13);
  }
}

TEST_CASE("spline field: derivatives agree with differences and are continuous at nodes") {
  const FieldGrid grid{{0, 0, 0}, {0.5, 0.5, 0.5}, {5, 5, 5}};
  const SplineField field(grid, samples(grid, [](const Vec3& x) {
                            return 0.3 * std::sin(7 * x[0] + 5 * x[1] * x[1] + 3 * x[2]);
                          }));
  for (const Vec3& x : {Vec3(0.2, 0.3, 0.7), Vec3(1.1, 1.6, 0.2), Vec3(1.8, 0.1, 1.9)})
    tests::check_derivatives(field, x, 0.1, 1, 1e-10);
  const Vec3 node(1, 0.5, 1.5), hair = Vec3::Constant(1e-13);
  const IndexHessian below = field.hessian(node - hair), above = field.hessian(node + hair);
  CHECK((below.gradient - above.gradient).norm() < 1e-11);
  CHECK((below.hessian - above.hessian).norm() < 1e-10);
}

TEST_CASE("spline field: smooth for one cell beyond its grid, constant farther out") {
  const FieldGrid grid = unit_grid(6);
  const SplineField field(grid, samples(grid, wavy));
  const Vec3 edge(1, 0.3, 0.4), cell(0.2, 0, 0);
  for (const double cells : {-0.1, 0.1, 0.9})
    tests::check_derivatives(field, edge + cells * cell, 0.01, 1, 1e-10);
  CHECK(std::abs(field.gradient(edge).gradient[0]) > 0.05);
  const IndexHessian inside = field.hessian(edge - 1e-13 * cell);
  const IndexHessian outside = field.hessian(edge + 1e-13 * cell);
  CHECK((inside.gradient - outside.gradient).norm() < 1e-11);
  CHECK((inside.hessian - outside.hessian).norm() < 1e-10);
  CHECK(field.excess(edge + 3 * cell) == field.excess(edge + 2 * cell));
  CHECK(field.gradient(edge + 2 * cell).gradient[0] == 0);
}

TEST_CASE("spline field: bad grids are rejected") {
  const FieldGrid grid = unit_grid(4);
  std::vector<double> values(64, 0.1);
  CHECK_NOTHROW(SplineField(grid, values));
  CHECK_THROWS_AS(SplineField(grid, std::span(values).first(63)), InputError);
  FieldGrid thin = grid, flat = grid;
  thin.nodes[1] = 3;
  flat.spacing[2] = 0;
  CHECK_THROWS_AS(SplineField(thin, std::span(values).first(48)), InputError);
  CHECK_THROWS_AS(SplineField(flat, values), InputError);
  values[5] = -1;
  CHECK_THROWS_AS(SplineField(grid, values), InputError);
  values[5] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(SplineField(grid, values), InputError);
}

TEST_CASE("spline field from a file: agrees with the field, bad files are rejected") {
  const auto path = std::filesystem::temp_directory_path() /
                    ("flatspeckle-field-" + std::to_string(::getpid()) + ".h5");
  const FieldGrid grid{{-1, 2, 0.5}, {0.3, 0.2, 0.1}, {4, 6, 9}};
  const auto values = samples(grid, wavy);
  const auto write = [&](const std::vector<double>& spacing, std::vector<Axis> axes) {
    ResultFile file(path);
    file.dataset("excess", values, axes, "1", "");
    file.attribute("excess", "origin", std::vector<double>{-1, 2, 0.5});
    file.attribute("excess", "spacing", spacing);
    file.commit();
  };
  using Size = std::size_t;
  const std::vector<Axis> axes{Size{4}, Size{6}, Size{9}};
  write({0.3, 0.2, 0.1}, axes);
  const Vec3 x(-0.7, 2.33, 0.91);
  CHECK(read_spline_field(path).excess(x) == SplineField(grid, values).excess(x));
  write({0.3, 0.2}, axes);
  CHECK_THROWS_AS(read_spline_field(path), InputError);
  write({0.3, 0.2, 0}, axes);
  CHECK_THROWS_AS(read_spline_field(path), InputError);
  write({0.3, 0.2, 0.1}, {Size{4}, Size{54}});
  CHECK_THROWS_AS(read_spline_field(path), InputError);
  write({0.3, 0.2, 0.1}, {Size{24}, Size{3}, Size{3}});
  CHECK_THROWS_AS(read_spline_field(path), InputError);
  std::filesystem::remove(path);
  CHECK_THROWS_AS(read_spline_field(path), InputError);
}

}  // namespace flatspeckle::grin::test_spline_field
