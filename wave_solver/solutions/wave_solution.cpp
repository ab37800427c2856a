#include "wave_solver/solutions/wave_solution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/contract.h"
#include "core/result/result_group.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/dense/columns.h"
#include "wave_solver/solutions/boundary_residual.h"

namespace flatspeckle::wave {

const DatasetTable solution_table{
    "solve",
    {{"far_field", Data::complex, "light_angle view_angle", "length^(1/2)",
      "far-field amplitude A, phase origin at r = 0"},
     {"near_field", Data::complex, "light_angle sensor", "1",
      "scattered field, without the incident wave"},
     {"scatterer", Data::numbers, "", "1", "number of the scatterer"},
     {"placement/x", Data::real, "scatterer", "length", "transverse position"},
     {"placement/z", Data::real, "scatterer", "length", "depth"},
     {"placement/radius", Data::real, "scatterer", "length", "radius, 0 for a point"},
     {"solve/basis_order", Data::count, "scatterer", "1", "highest angular order per scatterer"},
     {"solve/residual", Data::real, "", "1", "relative residual of the unscaled equations"},
     {"solve/condition", Data::real, "", "1",
      "condition of the scaled matrix, Frobenius norm, estimated"},
     {"solve/boundary_residual", Data::real, "", "1",
      "largest mismatch of the boundary conditions, unit incident waves"}}};

namespace {

std::vector<Complex> transposed(const std::vector<Complex>& matrix, std::size_t rows) {
  std::vector<Complex> result(matrix.size());
  const std::size_t columns = rows > 0 ? matrix.size() / rows : 0;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) result[i * columns + j] = matrix[j * rows + i];
  return result;
}

bool all_far(std::span<const View> views) {
  return std::none_of(views.begin(), views.end(), [](const View& view) { return view.near; });
}

// What each unknown adds in each view: [view][unknown].
std::vector<Complex> view_rows(const TMatrixSystem& system, std::span<const View> views) {
  if (all_far(views)) return system.far_rows(column(views, &View::angle));
  std::vector<Complex> rows;
  rows.reserve(views.size() * system.unknowns());
  for (const View& view : views) {
    const auto row = view.near ? system.near_row(view.point) : system.far_rows({&view.angle, 1});
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

// Of the waves and sources of a basis: [basis][unknown].
std::vector<Complex> right_sides(const TMatrixSystem& system, const LightBasis& basis) {
  auto sides = system.right_sides(basis.angles);
  for (const Vec2& source : basis.sources) {
    const auto side = system.source_side(source);
    sides.insert(sides.end(), side.begin(), side.end());
  }
  return sides;
}

void write_views(ResultFile& file, const std::string& name, const WaveSolution& solution,
                 const std::vector<View>& views) {
  if (views.empty()) return;
  write_view_axis(file, views);
  ResultGroup(file, solution_table).put(name, solution.fields(views));
}

void write_diagnosis(const ResultGroup& root, const Diagnosis& diagnosis) {
  root.put("solve/residual", diagnosis.residual);
  if (diagnosis.condition >= 0) root.put("solve/condition", diagnosis.condition);
  root.put("solve/boundary_residual", diagnosis.boundary_residual);
}

}  // namespace

WaveSolution::WaveSolution(TMatrixSystem system, std::vector<double> light_angles,
                           std::vector<Complex> coefficients)
    : system_(std::move(system)),
      light_angles_(std::move(light_angles)),
      coefficients_(std::move(coefficients)) {
  require_finite(coefficients_);
}

std::vector<int> WaveSolution::basis_order() const {
  std::vector<int> orders(system_.placement().size());
  for (std::size_t j = 0; j < orders.size(); ++j) orders[j] = system_.order(j);
  return orders;
}

std::span<const Complex> WaveSolution::coefficients(std::size_t light) const {
  return std::span(coefficients_).subspan(light * system_.unknowns(), system_.unknowns());
}

Complex WaveSolution::far_field(double view_angle, std::size_t light) const {
  return fields(std::vector{far_view(view_angle)})[light];
}

Complex WaveSolution::near_field(Vec2 point, std::size_t light) const {
  return fields(std::vector{near_sensor(point)})[light];
}

std::vector<Complex> WaveSolution::fields(std::span<const View> views) const {
  if (system_.unknowns() == 0) return std::vector<Complex>(light_angles_.size() * views.size());
  auto fields = transposed_product(view_rows(system_, views), coefficients_.data(),
                                   light_angles_.size(), system_.unknowns());
  require_finite(fields);
  return fields;
}

WaveSolution solve(const Placement& placement, double k, const std::vector<double>& light_angles,
                   const SolveOptions& options) {
  FS_EXPECT(k > 0 && options.tolerance > 0 && options.tolerance < 1);
  check_no_overlap(placement);
  TMatrixSystem system(placement, k, options.tolerance, options.sensors);
  auto found = solve_lights(system, light_angles, enclosing_circle(placement), options);
  WaveSolution solution(std::move(system), light_angles, std::move(found.coefficients));
  if (options.diagnose) found.diagnosis.boundary_residual = boundary_residual(solution);
  solution.diagnosis_ = found.diagnosis;
  solution.method_ = std::move(found.method);
  return solution;
}

FieldPlan make_field_plan(const Lights& lights, std::vector<View> views, double k,
                          const Circle& circle, double tolerance) {
  FieldPlan plan{basis_of(lights, k, circle, tolerance), {}, std::move(views)};
  if (all_far(plan.views)) {
    std::vector<double> angles;
    for (const View& view : plan.views) angles.push_back(view.angle + std::numbers::pi);
    plan.far_views = light_basis(angles, k, circle, tolerance);  // of the lights from there
    for (double& angle : plan.far_views.angles) angle -= std::numbers::pi;
  }
  return plan;
}

// With R the rows of the views and L the right sides of the lights, R^T M^-1 L either way round.
std::vector<Complex> scattered_fields(const Placement& placement, double k, const FieldPlan& plan,
                                      const SolveOptions& options) {
  FS_EXPECT(k > 0 && options.tolerance > 0 && options.tolerance < 1);
  const TMatrixSystem system(placement, k, options.tolerance, options.sensors);
  const std::size_t n = system.unknowns();
  const bool compressed = !plan.far_views.weights.empty();
  const auto views = compressed ? far_views(plan.far_views.angles) : plan.views;
  const auto rows = view_rows(system, views), sides = right_sides(system, plan.lights);
  const std::size_t lights = plan.lights.size();
  if (n == 0) return std::vector<Complex>(plan.views.size() * plan.lights.count());
  EquationSolver solver = solver_of(system, options);
  auto fields = views.size() < lights
                    ? transposed_product(solver.solve(rows), sides.data(), lights, n)
                    : transposed_product(rows, solver.solve(sides).data(), lights, n);
  fields = expanded(plan.lights, std::move(fields), views.size());  // [light][basis view]
  if (compressed)
    fields =
        transposed(expanded(plan.far_views, transposed(fields, views.size()), plan.lights.count()),
                   plan.lights.count());
  require_finite(fields);
  return fields;
}

void write_solution(ResultFile& file, const WaveSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec2>& sensors) {
  write_light_axis(file, solution.light_angles());
  write_views(file, "far_field", solution, column(view_angles, far_view));
  write_views(file, "near_field", solution, column(sensors, near_sensor));
  write_placement(file, solution.system().placement());
  const ResultGroup root(file, solution_table);
  root.put("solve/basis_order", column(solution.basis_order(), std::identity()));
  write_diagnosis(root, solution.diagnosis());
}

void write_placement(ResultFile& file, const Placement& placement) {
  const ResultGroup root(file, solution_table);
  root.number("scatterer", placement.size());
  root.put("placement/x", column(placement, [](const auto& placed) { return placed.position.x; }));
  root.put("placement/z", column(placement, [](const auto& placed) { return placed.position.z; }));
  root.put("placement/radius",
           column(placement, [](const auto& placed) { return placed.scatterer.disk_radius(); }));
}

}  // namespace flatspeckle::wave
