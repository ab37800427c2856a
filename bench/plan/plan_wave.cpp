#include <cmath>
#include <numbers>

#include "bench/plan/plan_rooms.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/copied_cluster.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/maps/field_map.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::bench {

namespace {

using namespace wave;

constexpr double k = 2 * std::numbers::pi;
const Scatterer point, disk{.kind = Scatterer::Kind::tm, .radius = 1 / k, .index = 1.5};

Placement draw(const Scatterer& scatterer, std::uint64_t count, double width, double depth) {
  RandomStream random(1, static_cast<std::uint64_t>(Stream::placement), 0);
  PlacementRule rule;
  rule.mean_count = static_cast<double>(count);
  rule.count = count;
  if (scatterer.is_disk()) rule.kind = PlacementRule::Kind::hard_disk;
  rule.min_gap = 0.1 * scatterer.disk_radius();
  return draw_placement({Domain::Kind::box, width, depth}, scatterer, rule, random);
}

std::vector<double> angles(int count, double first, double last) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(first + (last - first) * i / (count - 1));
  return values;
}

SolveOptions to(double tolerance, Method method = Method::dense) {
  return {.tolerance = tolerance, .sensors = {}, .diagnose = false, .method = method};
}

/// LU with row exchanges against the symmetric factor.
PlanRow row_exchanges(double cpu_seconds) {
  PlanRow row{.per = "solution"};
  const TMatrixSystem system(draw(point, 1000, 40, 20), k, 1e-9);
  const auto matrix = system.matrix();
  const auto side = system.right_sides(std::vector{0.0});
  const auto n = static_cast<lapack_int>(system.unknowns());
  const auto by_lu = [&] {
    auto lu = matrix;
    auto x = side;
    std::vector<lapack_int> pivots(system.unknowns());
    LAPACKE_zgesv(LAPACK_COL_MAJOR, n, 1, lu.data(), n, pivots.data(), x.data(), n);
    return x;
  };
  const auto symmetric = [&] { return DenseFactor(matrix, system.unknowns()).solve(side); };
  compare_values(row, by_lu, symmetric, 1e-10, cpu_seconds);
  return row;
}

/// Every entry by the rule for multipoles against what points need.
PlanRow multipoles(double cpu_seconds) {
  PlanRow row{.per = "matrix"};
  const TMatrixSystem system(draw(point, 400, 40, 20), k, 1e-9);
  const std::size_t n = system.unknowns();
  std::vector<std::size_t> all(n);
  for (std::size_t i = 0; i < n; ++i) all[i] = i;
  const auto by_entries = [&] {
    std::vector<Complex> matrix(n * n);
    system.entries(all, all, matrix.data(), n);
    return matrix;
  };
  const auto by_points = [&] {
    const auto matrix = system.matrix();
    return std::vector<Complex>(matrix.begin(), matrix.end());
  };
  compare_values(row, by_entries, by_points, 1e-12, cpu_seconds);
  return row;
}

/// Orders for 1e-12 where an ensemble's 1e-4 is asked.
PlanRow orders(double cpu_seconds) {
  constexpr double asked = 1e-4;
  PlanRow row{.per = "placement"};
  const Placement cylinders = draw(disk, 67, 20, 10);
  const FieldPlan plan{
      .lights = {{0}, {}, {}}, .far_views = {}, .views = far_views(angles(8, -1, 3))};
  compare_values(
      row, [&] { return scattered_fields(cylinders, k, plan, to(1e-12)); },
      [&] { return scattered_fields(cylinders, k, plan, to(asked)); }, asked, cpu_seconds);
  return row;
}

/// 256 lights solved one by one, for one view, against the view alone.
PlanRow reciprocity(double cpu_seconds) {
  PlanRow row{.per = "placement"};
  const Placement points = draw(point, 200, 20, 10);
  const auto lights = angles(256, -0.7, 0.7);
  const double view = 0.3;
  const auto for_lights = [&] {
    const TMatrixSystem system(points, k, 1e-9);
    EquationSolver solver(system, Method::dense, 1e-9);
    const auto x = solver.solve(system.right_sides(lights));
    const auto seen = system.far_rows(std::vector{view});
    std::vector<Complex> fields(lights.size());
    for (std::size_t l = 0; l < lights.size(); ++l)
      for (std::size_t i = 0; i < seen.size(); ++i) fields[l] += seen[i] * x[l * seen.size() + i];
    return fields;
  };
  const FieldPlan plan{.lights = {lights, {}, {}}, .far_views = {}, .views = {far_view(view)}};
  compare_values(
      row, for_lights, [&] { return scattered_fields(points, k, plan, to(1e-9)); }, 1e-10,
      cpu_seconds);
  return row;
}

/// 1024 lights and views each against the few that stand for all of them.
PlanRow lights_that_others_make(double cpu_seconds) {
  constexpr double tolerance = 1e-9;
  PlanRow row{.per = "placement"};
  const Placement points = draw(point, 200, 20, 10);
  const auto fan = angles(1024, -0.7, 0.7);
  const FieldPlan all{.lights = {fan, {}, {}}, .far_views = {}, .views = far_views(fan)};
  const Circle circle{{0, 5}, std::hypot(10, 5)};
  const FieldPlan few = make_field_plan(Lights(fan), far_views(fan), k, circle, tolerance);
  compare_values(
      row, [&] { return scattered_fields(points, k, all, to(tolerance)); },
      [&] { return scattered_fields(points, k, few, to(tolerance)); }, tolerance, cpu_seconds);
  return row;
}

/// Residual, condition and mismatch on the rims, which an ensemble does not ask for.
PlanRow diagnosis(double cpu_seconds) {
  PlanRow row{.per = "placement"};
  const Placement cylinders = draw(disk, 67, 20, 10);
  const auto views = far_views(angles(8, -1, 3));
  SolveOptions asked = to(1e-6);
  asked.diagnose = true;
  const auto fields = [&](const SolveOptions& options) {
    return solve(cylinders, k, {0}, options).fields(views);
  };
  compare_values(
      row, [&] { return fields(asked); }, [&] { return fields(to(1e-6)); }, 1e-12, cpu_seconds);
  return row;
}

/// The dense matrix against recursive skeletonization.
PlanRow whole_matrix(double cpu_seconds) {
  constexpr double tolerance = 1e-6;
  PlanRow row{.per = "placement"};
  const std::uint64_t count = cpu_seconds < 1 ? 500 : 4000;
  const double depth = std::sqrt(static_cast<double>(count));
  const Placement points = draw(point, count, 2 * depth, depth / 2);
  const FieldPlan plan{
      .lights = {{0}, {}, {}}, .far_views = {}, .views = far_views(angles(64, -1, 3))};
  compare_values(
      row, [&] { return scattered_fields(points, k, plan, to(tolerance)); },
      [&] { return scattered_fields(points, k, plan, to(tolerance, Method::fast)); },
      100 * tolerance, cpu_seconds);
  return row;
}

/// Every scatterer at every pixel against sums on a grid.
PlanRow pixels_one_by_one(double cpu_seconds) {
  constexpr double tolerance = 1e-8;
  PlanRow row{.per = "map"};
  const Placement cylinders = draw(disk, 100, 20, 10);
  const MapGrid grid{{-11, -1}, {11, 11}, 220, 120};
  SolveOptions options = to(tolerance);
  options.sensors = map_sensors(grid, cylinders);
  const WaveSolution solution = solve(cylinders, k, {0}, options);
  const auto map = [&](FieldMap::Route route) {
    FieldMap field(solution, grid, tolerance, route);
    return field.field({0, 0, grid.nx, grid.nz});
  };
  compare_values(
      row, [&] { return map(FieldMap::Route::direct); },
      [&] { return map(FieldMap::Route::fastest); }, tolerance, cpu_seconds);
  return row;
}

/// All disks of copies of a cluster against its T-matrix, made once.
PlanRow disks_of_copies(double cpu_seconds) {
  constexpr double tolerance = 1e-9;
  PlanRow row{.per = "placement"};
  const Scatterer dense{.kind = Scatterer::Kind::tm, .radius = 0.1, .index = 1.5};
  Placement disks;
  for (int i = 0; i < 16; ++i)
    disks.push_back({{0.25 * (i % 4) - 0.4, 0.25 * (i / 4) - 0.4}, dense});
  const auto cluster = cluster_t_matrix(disks, k, 0.8, tolerance);
  const auto places = rows_of_places(3, 4, 2 * cluster.radius + 1);
  const auto views = far_views(angles(16, -1, 3));
  compare_values(
      row, [&] { return solve(copies(disks, places), k, {0}, to(tolerance)).fields(views); },
      [&] { return ClusterSolution(cluster, places, {0}, to(tolerance)).fields(views); }, 1e-7,
      cpu_seconds);
  return row;
}

}  // namespace

std::vector<PlanCase> wave_plan_cases() {
  blas_single_thread();
  const auto row = [](const std::string& left_out, const std::string& scene, const auto& run) {
    return named("wave solver", left_out, scene, run);
  };
  return {row("row exchanges", "1000 points", row_exchanges),
          row("multipoles", "400 points", multipoles),
          row("orders beyond 1e-4", "box_cylinders", orders),
          row("all lights but one view", "200 points, 256 lights", reciprocity),
          row("lights that others make up", "200 points, 1024 x 1024", lights_that_others_make),
          row("diagnosis", "box_cylinders", diagnosis),
          row("the matrix", "4000 points (500 in a quick look)", whole_matrix),
          row("sums pixel by pixel", "100 cylinders, 26400 pixels", pixels_one_by_one),
          row("disks of copies", "12 copies of 16 cylinders", disks_of_copies)};
}

}  // namespace flatspeckle::bench
