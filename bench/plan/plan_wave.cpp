#include <cmath>
#include <memory>

#include "bench/plan/plan_timing.h"
#include "bench/scenes/copied_cluster.h"
#include "bench/scenes/standard_scenes.h"
#include "flatland/scene/periodic_placement.h"
#include "wave_solver/clusters/cluster_solution.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/maps/field_map.h"
#include "wave_solver/periodic/scattering_matrix.h"
#include "wave_solver/solutions/wave_solution.h"
#include "wave_solver/spheres/sphere_equations.h"
#include "wave_solver/spheres/sphere_pairs.h"
#include "wave_solver/sums/space_product.h"

namespace flatspeckle::bench {

namespace {

using namespace wave;

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

/// Returns a plan of the fields in eight detection directions under one illumination.
FieldPlan eight_views() {
  return {.lights = {{0}, {}, {}}, .far_views = {}, .views = far_views(angles(8, -1, 3))};
}

ValueFunction fields_of(const Placement& placement, const FieldPlan& plan,
                        const SolveOptions& options) {
  return [=] { return scattered_fields(placement, k, plan, options); };
}

/// Compares LU factorisation with row exchanges against the symmetric factorisation.
TwoAlternatives row_exchanges(bool) {
  const TMatrixSystem system(draw(point, 1000, 40, 20), k, 1e-9);
  const auto matrix = system.matrix();
  const auto side = system.right_hand_sides(std::vector{0.0});
  const std::size_t unknowns = system.unknowns();
  const auto by_lu = [=] {
    auto lu = matrix;
    auto x = side;
    const auto n = static_cast<lapack_int>(unknowns);
    std::vector<lapack_int> pivots(unknowns);
    LAPACKE_zgesv(LAPACK_COL_MAJOR, n, 1, lu.data(), n, pivots.data(), x.data(), n);
    return x;
  };
  return {by_lu, [=] { return DenseFactor(matrix, unknowns).solve(side); }};
}

/// Compares the matrix entries computed for general multipoles with those for points.
TwoAlternatives multipoles(bool) {
  const auto system = std::make_shared<const TMatrixSystem>(draw(point, 400, 40, 20), k, 1e-9);
  const std::size_t n = system->unknowns();
  std::vector<std::size_t> all(n);
  for (std::size_t i = 0; i < n; ++i) all[i] = i;
  const auto by_entries = [=] {
    std::vector<Complex> matrix(n * n);
    system->entries(all, all, matrix.data(), n);
    return matrix;
  };
  const auto by_points = [=] {
    const auto matrix = system->matrix();
    return std::vector<Complex>(matrix.begin(), matrix.end());
  };
  return {by_entries, by_points};
}

/// Compares multipole orders for a tolerance of 1e-12 with those for 1e-4, which suffices for an
/// ensemble.
TwoAlternatives orders(bool) {
  const Placement cylinders = draw(disk, 67, 20, 10);
  return {fields_of(cylinders, eight_views(), to(1e-12)),
          fields_of(cylinders, eight_views(), to(1e-4))};
}

/// Compares solutions for 256 illuminations with the reciprocal solution for the one detection
/// direction.
TwoAlternatives reciprocity(bool) {
  const Placement points = draw(point, 200, 20, 10);
  const auto lights = angles(256, -0.7, 0.7);
  const double view = 0.3;
  const auto for_lights = [=] {
    const TMatrixSystem system(points, k, 1e-9);
    EquationSolver solver(system, Method::dense, 1e-9);
    const auto x = solver.solve(system.right_hand_sides(lights));
    const auto seen = system.far_rows(std::vector{view});
    std::vector<Complex> fields(lights.size());
    for (std::size_t l = 0; l < lights.size(); ++l)
      for (std::size_t i = 0; i < seen.size(); ++i) fields[l] += seen[i] * x[l * seen.size() + i];
    return fields;
  };
  const FieldPlan plan{.lights = {lights, {}, {}}, .far_views = {}, .views = {far_view(view)}};
  return {for_lights, fields_of(points, plan, to(1e-9))};
}

/// Compares solving for 1024 illuminations and 1024 detection directions with solving for a few,
/// from which the others are interpolated.
TwoAlternatives lights_that_others_make(bool) {
  constexpr double tolerance = 1e-9;
  const Placement points = draw(point, 200, 20, 10);
  const auto fan = angles(1024, -0.7, 0.7);
  const FieldPlan all{.lights = {fan, {}, {}}, .far_views = {}, .views = far_views(fan)};
  const Circle circle{{0, 5}, std::hypot(10, 5)};
  return {fields_of(points, all, to(tolerance)),
          fields_of(points, make_field_plan(Lights(fan), far_views(fan), k, circle, tolerance),
                    to(tolerance))};
}

/// Computes residual, condition and boundary mismatch, which ensembles do not need.
TwoAlternatives diagnosis(bool) {
  const auto fields = [cylinders = draw(disk, 67, 20, 10)](const SolveOptions& options) {
    return solve(cylinders, k, {0}, options).fields(eight_views().views);
  };
  SolveOptions asked = to(1e-6);
  asked.diagnose = true;
  return {[=] { return fields(asked); }, [=] { return fields(to(1e-6)); }};
}

/// Compares the dense matrix with recursive skeletonization.
TwoAlternatives whole_matrix(bool is_quick) {
  constexpr double tolerance = 1e-6;
  const std::uint64_t count = is_quick ? 500 : 4000;
  const double depth = std::sqrt(static_cast<double>(count));
  const Placement points = draw(point, count, 2 * depth, depth / 2);
  const FieldPlan plan{
      .lights = {{0}, {}, {}}, .far_views = {}, .views = far_views(angles(64, -1, 3))};
  return {fields_of(points, plan, to(tolerance)),
          fields_of(points, plan, to(tolerance, Method::fast))};
}

/// Compares a field map summed over all scatterers at each pixel with one from sums on a grid.
TwoAlternatives pixels_one_by_one(bool) {
  constexpr double tolerance = 1e-8;
  const Placement cylinders = draw(disk, 100, 20, 10);
  const MapGrid grid{{-11, -1}, {11, 11}, 220, 120};
  SolveOptions options = to(tolerance);
  options.sensors = map_sensors(grid, cylinders);
  const auto solution = std::make_shared<const WaveSolution>(solve(cylinders, k, {0}, options));
  const auto map = [=](FieldMap::Route route) {
    FieldMap field(*solution, grid, tolerance, route);
    return field.field({0, 0, grid.nx, grid.nz});
  };
  return {[=] { return map(FieldMap::Route::direct); },
          [=] { return map(FieldMap::Route::fastest); }};
}

/// Compares direct sums over all pairs of points in space with pre-corrected FFT.
TwoAlternatives pairs_in_space(bool is_quick) {
  constexpr double tolerance = 1e-5, per_volume = 10;
  RandomStream random(1, static_cast<std::uint64_t>(Stream::placement), 0);
  const double count = is_quick ? 8000 : 20000, side = std::cbrt(count / per_volume);
  PlacementRule rule;
  rule.mean_count = count;
  rule.count = static_cast<std::uint64_t>(count);
  const Placement points =
      draw_placement({Domain::Kind::box, side, side, side}, point, rule, random);
  BasisOrders orders(k, tolerance, sphere_rules());
  const auto equations =
      std::make_shared<const SphereEquations>(points, k, orders.basis(points, {}));
  const auto sums = std::make_shared<const SpaceProduct>(*equations, tolerance);
  const auto x = equations->right_hand_sides(Lights({0.3}), tolerance);
  return {[=] { return equations->apply(x); }, [=] { return (*sums)(x); }};
}

/// Compares a system of all disks in all copies of a cluster with one that uses the cluster's
/// T-matrix, computed once.
TwoAlternatives disks_of_copies(bool) {
  constexpr double tolerance = 1e-9;
  const Scatterer dense{.kind = Scatterer::Kind::tm, .radius = 0.1, .index = 1.5};
  Placement disks;
  for (int i = 0; i < 16; ++i)
    disks.push_back({{0.25 * (i % 4) - 0.4, 0.25 * (i / 4) - 0.4}, dense});
  const auto cluster = cluster_t_matrix(disks, k, 0.8, tolerance);
  const auto places = rows_of_places(3, 4, 2 * cluster.radius + 1);
  const auto views = far_views(angles(16, -1, 3));
  return {[=] { return solve(copies(disks, places), k, {0}, to(tolerance)).fields(views); },
          [=] { return ClusterSolution(cluster, places, {0}, to(tolerance)).fields(views); }};
}

/// Compares scattering matrices of a periodic slab by the dense matrix with those by waves to and
/// from the outside alone.
TwoAlternatives inside_of_slab(bool is_quick) {
  constexpr double tolerance = 1e-6, width = 30.3;
  SceneSpec spec;
  spec.scatterer = "point";
  spec.width = width;
  spec.depth = 20;
  spec.count = is_quick ? 600 : 3000;
  RandomStream random(1, static_cast<std::uint64_t>(Stream::placement), 0);
  const Placement points = draw_periodic_placement(make_scene(spec), random);
  const auto by = [=](Method method) {
    return [=] { return scattering_matrix(points, k, {width, 0}, to(tolerance, method)).s; };
  };
  return {by(Method::dense), by(Method::fast)};
}

}  // namespace

std::vector<PlanCase> wave_plan_cases() {
  blas_single_thread();
  const auto row = [](const std::string& left_out, const std::string& scene, const std::string& per,
                      double limit, TwoAlternatives (*make)(bool)) {
    return case_of_values({"wave solver", left_out, scene, per}, limit, make);
  };
  return {row("row exchanges", "1000 points", "solution", 1e-10, row_exchanges),
          row("multipoles", "400 points", "matrix", 1e-12, multipoles),
          row("orders beyond 1e-4", "box_cylinders", "placement", 1e-4, orders),
          row("all lights but one view", "200 points, 256 lights", "placement", 1e-10, reciprocity),
          row("lights interpolated from others", "200 points, 1024 x 1024", "placement", 1e-9,
              lights_that_others_make),
          row("diagnosis", "box_cylinders", "placement", 1e-12, diagnosis),
          row("the matrix", "4000 points (500 in a quick run)", "placement", 1e-4, whole_matrix),
          row("unknowns inside a slab", "3000 points (600 in a quick run)", "scattering matrix",
              1e-4, inside_of_slab),
          row("sums pixel by pixel", "100 cylinders, 26400 pixels", "map", 1e-8, pixels_one_by_one),
          row("pairs beyond a wavelength", "20000 points in space (8000 in a quick run)", "product",
              1e-5, pairs_in_space),
          row("disks of copies", "12 copies of 16 cylinders", "placement", 1e-7, disks_of_copies)};
}

}  // namespace flatspeckle::bench
