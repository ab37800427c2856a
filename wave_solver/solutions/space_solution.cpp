#include "wave_solver/solutions/space_solution.h"

#include <algorithm>
#include <utility>

#include "core/contract.h"
#include "core/error.h"
#include "core/result/result_group.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/solutions/space_checks.h"
#include "wave_solver/spheres/sphere_pairs.h"

namespace flatspeckle::wave {

const DatasetTable space_solution_table{
    "solve in space",
    {{"far_field", Data::complex, "LIGHT VIEW", "length",
      "far-field amplitude A, phase origin at r = 0"},
     {"near_field", Data::complex, "LIGHT sensor", "1",
      "scattered field, without the light itself"},
     {"scatterer", Data::numbers, "", "1", "number of the scatterer"},
     {"placement/x", Data::real, "scatterer", "length", "transverse position"},
     {"placement/y", Data::real, "scatterer", "length", "transverse position"},
     {"placement/z", Data::real, "scatterer", "length", "depth"},
     {"placement/radius", Data::real, "scatterer", "length", "radius, 0 for a point"},
     {"solve/basis_order", Data::count, "scatterer", "1", "highest degree l per scatterer"},
     {"solve/residual", Data::real, "", "1", "relative residual of the unscaled equations"},
     {"solve/condition", Data::real, "", "1",
      "estimated condition number of the scaled matrix, in the Frobenius norm"},
     {"solve/boundary_residual", Data::real, "", "1",
      "largest mismatch of the boundary conditions, relative to the light"},
     {"invariants/power", Data::invariant, "", "1",
      "|extinction - scattering - absorption| / extinction of plane waves"}}};

namespace {

EquationSolver space_solver(const SphereEquations& equations, const SolveOptions& options) {
  if (options.method == Method::fast)
    throw InputError("solver", "fast", "requires dimension = 2; use dense or krylov");
  const Method method = options.method == Method::automatic
                            ? method_in_space(equations.unknowns(), equations.only_points())
                            : options.method;
  return {solvable(equations), method,
          options.sensors.empty() ? options.tolerance : options.tolerance / 10};
}

void require_sensors_outside(const Placement& placement, std::span<const View> views) {
  for (const View& view : views)
    if (view.near) require_outside(placement, view.point);
}

// Returns the products of coefficients, [light][unknown], with the rows of the views:
// [light][view]. Rows are computed a block of views at a time.
std::vector<Complex> viewed(const SphereEquations& equations, std::span<const View> views,
                            const std::vector<Complex>& coefficients, std::size_t lights) {
  constexpr std::size_t block = 1 << 20;  // elements of the rows
  const std::size_t n = equations.unknowns(), most = std::max<std::size_t>(1, block / n);
  std::vector<Complex> fields(lights * views.size());
  for (std::size_t first = 0; first < views.size(); first += most) {
    const std::size_t count = std::min(most, views.size() - first);
    const auto part = transposed_product(equations.view_rows(views.subspan(first, count)),
                                         coefficients.data(), lights, n);
    for (std::size_t light = 0; light < lights; ++light)
      std::copy_n(&part[light * count], count, &fields[light * views.size() + first]);
  }
  return fields;
}

}  // namespace

SpaceSolution::SpaceSolution(SphereEquations equations, Lights lights,
                             std::vector<Complex> coefficients)
    : equations_(std::move(equations)),
      lights_(std::move(lights)),
      coefficients_(std::move(coefficients)) {
  require_finite(coefficients_);
}

std::span<const Complex> SpaceSolution::coefficients(std::size_t light) const {
  return std::span(coefficients_).subspan(light * equations_.unknowns(), equations_.unknowns());
}

std::vector<Complex> SpaceSolution::fields(std::span<const View> views) const {
  if (equations_.unknowns() == 0 || views.empty())
    return std::vector<Complex>(lights_.size() * views.size());
  require_sensors_outside(equations_.placement(), views);
  auto fields = viewed(equations_, views, coefficients_, lights_.size());
  require_finite(fields);
  return fields;
}

SpaceSolution solve_in_space(const Placement& placement, double k, const Lights& lights,
                             const SolveOptions& options) {
  FS_EXPECT(k > 0 && options.tolerance > 0 && options.tolerance < 1);
  check_no_overlap(placement);
  BasisOrders orders(k, options.tolerance, sphere_rules());
  SphereEquations equations(placement, k, orders.basis(placement, options.sensors));
  if (equations.unknowns() == 0) {
    SpaceSolution nothing(std::move(equations), lights, {});
    nothing.diagnosis_ = {.residual = 0, .boundary_residual = 0};
    nothing.method_ = "no scatterers";
    return nothing;
  }
  const auto rhs = equations.right_hand_sides(lights, options.tolerance);
  Diagnosis found;
  std::string method;
  std::vector<Complex> coefficients;
  {
    EquationSolver solver = space_solver(equations, options);
    coefficients = solver.solve(rhs, options.diagnose);
    if (options.diagnose) {
      // The unscaled equations are the scaled ones times the square roots of these weights.
      std::vector<double> weights;
      for (std::size_t i = 0; i < equations.unknowns(); ++i)
        weights.push_back(equations.strength(i));
      found.residual = relative_size(solver.combined_residual(), rhs, weights);
      found.condition = solver.condition();
    }
    method = solver.description();
  }
  SpaceSolution solution(std::move(equations), lights, std::move(coefficients));
  solution.diagnosis_ = found;
  solution.method_ = std::move(method);
  if (!options.diagnose) return solution;
  solution.diagnosis_.boundary_residual = boundary_residual(solution, options.tolerance);
  solution.diagnosis_.power = power_balance(solution);
  return solution;
}

void write_solution(ResultFile& file, const SpaceSolution& solution,
                    const std::vector<View>& far_views, const std::vector<View>& near_sensors,
                    const std::optional<FarCamera>& camera) {
  const ResultGroup root(file, space_solution_table);
  write_light_axis(file, solution.lights());
  if (!far_views.empty()) {
    write_view_axis(file, far_views, camera);
    root.put("far_field", solution.fields(far_views));
  }
  if (!near_sensors.empty()) {
    write_view_axis(file, near_sensors);
    root.put("near_field", solution.fields(near_sensors));
  }
  const SphereEquations& equations = solution.equations();
  const Placement& placement = equations.placement();
  root.number("scatterer", placement.size());
  const auto put_column = [&](const std::string& name, double Vec::*coordinate) {
    root.put(name,
             column(placement, [&](const auto& placed) { return placed.position.*coordinate; }));
  };
  put_column("placement/x", &Vec::x);
  put_column("placement/y", &Vec::y);
  put_column("placement/z", &Vec::z);
  root.put("placement/radius",
           column(placement, [](const auto& placed) { return placed.scatterer.disk_radius(); }));
  std::vector<std::uint64_t> orders;
  for (std::size_t j = 0; j < placement.size(); ++j)
    orders.push_back(static_cast<std::uint64_t>(equations.order(j)));
  root.put("solve/basis_order", std::span(orders));
  const Diagnosis& diagnosis = solution.diagnosis();
  root.put("solve/residual", diagnosis.residual);
  if (diagnosis.condition >= 0) root.put("solve/condition", diagnosis.condition);
  root.put("solve/boundary_residual", diagnosis.boundary_residual);
  root.check("invariants/power", diagnosis.power);
}

SpaceFields::SpaceFields(const Scene& scene, const SolveOptions& options)
    : k_(scene.k),
      lights_(scene.request.lights),
      views_(scene.request.views),
      options_(options),
      orders_(std::make_shared<BasisOrders>(scene.k, options.tolerance, sphere_rules())),
      lock_(std::make_shared<std::mutex>()) {}

std::vector<Complex> SpaceFields::of(const Placement& placement) const {
  if (placement.empty()) return std::vector<Complex>(lights_.size() * views_.size());
  const SphereEquations equations(placement, k_, [&] {
    const std::lock_guard held(*lock_);
    return orders_->basis(placement, options_.sensors);
  }());
  require_sensors_outside(placement, views_);
  const auto rhs = equations.right_hand_sides(lights_, options_.tolerance);
  EquationSolver solver = space_solver(equations, options_);
  auto fields = views_.size() < lights_.size()
                    ? transposed_product(solver.solve(equations.view_rows(views_)), rhs.data(),
                                         lights_.size(), equations.unknowns())
                    : viewed(equations, views_, solver.solve(rhs), lights_.size());
  require_finite(fields);
  return fields;
}

}  // namespace flatspeckle::wave
