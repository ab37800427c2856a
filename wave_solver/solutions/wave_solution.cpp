#include "wave_solver/solutions/wave_solution.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "core/contract.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/solutions/boundary_residual.h"
#include "wave_solver/solutions/solution_invariants.h"

namespace flatspeckle::wave {

const DatasetTable spectrum_table{
    "solve at several wavelengths",
    {{"wavelength", Data::scale, "", "length", "wavelength outside the scatterers"},
     {"far_field", Data::complex, "wavelength light_angle view_angle", "length^(1/2)",
      "far-field amplitude A, phase origin at r = 0"},
     {"near_field", Data::complex, "wavelength light_angle sensor", "1",
      "scattered field, without the incident wave"},
     {"solve/unknowns", Data::count, "wavelength", "1", "number of unknowns of the equations"},
     {"solve/highest_order", Data::count, "wavelength", "1", "highest angular order"},
     {"solve/residual", Data::real, "wavelength", "1",
      "relative residual of the unscaled equations"},
     {"solve/boundary_residual", Data::real, "wavelength", "1",
      "largest mismatch of the boundary conditions, for unit incident waves"},
     {"invariants/power", Data::invariant, "wavelength", "1",
      "|extinction - scattering - absorption| / extinction"},
     {"invariants/rounding", Data::invariant, "wavelength", "1",
      "relative change of the far fields if all radii change by a rounding error"},
     {"invariants/truncation", Data::invariant, "wavelength", "1",
      "relative change of the fields when orders are raised, if gap plasmons may resonate"}}};

Spectrum::Spectrum(const std::vector<double>& view_angles, const std::vector<Vec>& sensors)
    : far_views_(far_views(view_angles)), near_sensors_(column(sensors, near_sensor)) {}

void Spectrum::add(double wavelength, const WaveSolution& solution) {
  const auto append = [&](std::vector<Complex>& fields, const std::vector<View>& views) {
    const auto more = solution.fields(views);
    fields.insert(fields.end(), more.begin(), more.end());
  };
  append(far_, far_views_);
  append(near_, near_sensors_);
  wavelengths_.push_back(wavelength);
  light_angles_ = solution.light_angles();
  placement_ = solution.system().placement();
  unknowns_.push_back(solution.system().unknowns());
  const auto orders = solution.basis_order();
  orders_.push_back(orders.empty() ? 0
                                   : static_cast<std::uint64_t>(*std::ranges::max_element(orders)));
  const Diagnosis& diagnosis = solution.diagnosis();
  residual_.push_back(diagnosis.residual);
  boundary_residual_.push_back(diagnosis.boundary_residual);
  power_.push_back(diagnosis.power);
  rounding_.push_back(diagnosis.rounding);
  truncation_.push_back(diagnosis.truncation);
}

double Spectrum::residual() const {
  return *std::ranges::max_element(residual_);
}

std::size_t Spectrum::unknowns() const {
  return *std::ranges::max_element(unknowns_);
}

void Spectrum::write(ResultFile& file) const {
  const ResultGroup root(file, spectrum_table);
  root.put("wavelength", wavelengths_);
  write_light_axis(file, light_angles_);
  const auto put = [&](const std::string& name, const std::vector<Complex>& fields,
                       const std::vector<View>& views) {
    if (views.empty()) return;
    write_view_axis(file, views);
    root.put(name, fields);
  };
  put("far_field", far_, far_views_);
  put("near_field", near_, near_sensors_);
  root.put("solve/unknowns", unknowns_);
  root.put("solve/highest_order", orders_);
  root.put("solve/residual", residual_);
  root.put("solve/boundary_residual", boundary_residual_);
  root.check("invariants/power", power_);
  root.check("invariants/rounding", rounding_);
  root.check("invariants/truncation", truncation_);
  write_placement(file, placement_);
}

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
      "estimated condition number of the scaled matrix, in the Frobenius norm"},
     {"solve/boundary_residual", Data::real, "", "1",
      "largest mismatch of the boundary conditions, for unit incident waves"},
     {"invariants/power", Data::invariant, "", "1",
      "|extinction - scattering - absorption| / extinction"},
     {"invariants/rounding", Data::invariant, "", "1",
      "relative change of the far fields if all radii change by a rounding error"},
     {"invariants/truncation", Data::invariant, "", "1",
      "relative change of the fields when orders are raised, if gap plasmons may resonate"}}};

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

// Returns the contribution of each unknown to the field in each view: [view][unknown].
std::vector<Complex> view_rows(const TMatrixSystem& system, std::span<const View> views) {
  if (all_far(views)) return system.far_rows(column(views, &View::angle));
  for (const View& view : views)
    if (view.near) require_outside(system.placement(), view.point);
  return system.view_rows(views);
}

// If gap plasmons may resonate, the equations are solved again with basis orders raised by these
// factors, one after the other, until the fields no longer change.
const std::vector<double> confirming_growths{1.25, 1.6, 2};

double relative_change(const std::vector<Complex>& before, const std::vector<Complex>& after) {
  double changes = 0, sizes = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    changes += std::norm(after[i] - before[i]);
    sizes += std::norm(after[i]);
  }
  return sizes > 0 ? std::sqrt(changes / sizes) : 0;
}

// Return the views at which solutions with different orders are compared: far views in directions
// all around, and the sensors outside the scatterers.
std::vector<View> confirming_far_views() {
  constexpr int around = 16;
  std::vector<View> views;
  for (int i = 0; i < around; ++i) views.push_back(far_view(2 * std::numbers::pi * i / around));
  return views;
}
std::vector<View> confirming_near_views(const Placement& placement, std::vector<Vec> sensors) {
  std::erase_if(sensors, [&](Vec sensor) {
    return std::ranges::any_of(placement, [&](const PlacedScatterer& placed) {
      return length(sensor - placed.position) <= placed.scatterer.disk_radius();
    });
  });
  return column(sensors, near_sensor);
}

double relative_change(const WaveSolution& before, const WaveSolution& after,
                       const SolveOptions& options) {
  const auto of = [&](const std::vector<View>& views) {
    return relative_change(before.fields(views), after.fields(views));
  };
  return std::max(of(confirming_far_views()),
                  of(confirming_near_views(after.system().placement(), options.sensors)));
}

// Returns the right-hand sides of the waves and sources of a basis: [basis][unknown].
std::vector<Complex> right_hand_sides(const TMatrixSystem& system, const LightBasis& basis) {
  auto rhs = system.right_hand_sides(basis.angles);
  for (const Vec& source : basis.sources) {
    const auto side = system.source_right_hand_side(source);
    rhs.insert(rhs.end(), side.begin(), side.end());
  }
  return rhs;
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
  root.check("invariants/power", diagnosis.power);
  root.check("invariants/rounding", diagnosis.rounding);
  root.check("invariants/truncation", diagnosis.truncation);
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

Complex WaveSolution::near_field(Vec point, std::size_t light) const {
  return fields(std::vector{near_sensor(point)})[light];
}

std::vector<Complex> WaveSolution::fields(std::span<const View> views) const {
  return fields(views, 0, light_angles_.size());
}

std::vector<Complex> WaveSolution::fields(std::span<const View> views, std::size_t light) const {
  return fields(views, light, 1);
}

std::vector<Complex> WaveSolution::fields(std::span<const View> views, std::size_t first_light,
                                          std::size_t lights) const {
  if (system_.unknowns() == 0) return std::vector<Complex>(lights * views.size());
  auto fields = transposed_product(view_rows(system_, views),
                                   &coefficients_[first_light * system_.unknowns()], lights,
                                   system_.unknowns());
  require_finite(fields);
  return fields;
}

WaveSolution solve(const Placement& placement, double k, const std::vector<double>& light_angles,
                   const SolveOptions& options) {
  FS_EXPECT(k > 0 && options.tolerance > 0 && options.tolerance < 1);
  check_no_overlap(placement);
  const auto solved = [&](double growth) {
    TMatrixSystem system(placement, k, options.tolerance, options.sensors, growth);
    auto found =
        solve_lights(system, light_angles, enclosing_circle(placement), options,
                     options.diagnose ? system.radius_derivatives() : std::vector<Complex>{});
    WaveSolution solution(std::move(system), light_angles, std::move(found.coefficients));
    solution.diagnosis_ = found.diagnosis;
    solution.method_ = std::move(found.method);
    return solution;
  };
  WaveSolution solution = solved(1);
  if (solution.system().has_gap_plasmons())
    for (const double growth : confirming_growths) {
      const auto before = std::exchange(solution, solved(growth));
      const double change = relative_change(before, solution, options);
      solution.diagnosis_.truncation = {change, options.tolerance};
      if (change <= options.tolerance) break;
    }
  if (!options.diagnose) return solution;
  solution.diagnosis_.boundary_residual = boundary_residual(solution);
  solution.diagnosis_.power = power_balance(solution, options.tolerance);
  return solution;
}

FieldPlan make_field_plan(const Lights& lights, std::vector<View> views, double k,
                          const Circle& circle, double tolerance) {
  FieldPlan plan{basis_of(lights, k, circle, tolerance), {}, std::move(views)};
  if (plan.lights.size() > 1 && all_far(plan.views)) {  // a single light is solved for directly
    std::vector<double> angles;
    for (const View& view : plan.views) angles.push_back(view.angle + std::numbers::pi);
    // By reciprocity this is a basis of plane waves that come from the view directions.
    plan.far_views = light_basis(angles, k, circle, tolerance);
    for (double& angle : plan.far_views.angles) angle -= std::numbers::pi;
  }
  return plan;
}

namespace {

// Returns R^T M^-1 L, where R are the rows of the views and L the right-hand sides of the lights.
// The equations are solved for R or for L, whichever has fewer columns.
std::vector<Complex> fields_of(const TMatrixSystem& system, const FieldPlan& plan,
                               const SolveOptions& options) {
  const std::size_t n = system.unknowns();
  const bool compressed = !plan.far_views.weights.empty();
  const auto views = compressed ? far_views(plan.far_views.angles) : plan.views;
  const auto rows = view_rows(system, views), rhs = right_hand_sides(system, plan.lights);
  const std::size_t lights = plan.lights.size();
  if (n == 0) return std::vector<Complex>(plan.views.size() * plan.lights.count());
  EquationSolver solver = solver_of(system, options);
  auto fields = views.size() < lights
                    ? transposed_product(solver.solve(rows), rhs.data(), lights, n)
                    : transposed_product(rows, solver.solve(rhs).data(), lights, n);
  fields = expanded(plan.lights, std::move(fields), views.size());  // [light][basis view]
  if (compressed)
    fields =
        transposed(expanded(plan.far_views, transposed(fields, views.size()), plan.lights.count()),
                   plan.lights.count());
  require_finite(fields);
  return fields;
}

}  // namespace

std::vector<Complex> scattered_fields(const Placement& placement, double k, const FieldPlan& plan,
                                      const SolveOptions& options) {
  FS_EXPECT(k > 0 && options.tolerance > 0 && options.tolerance < 1);
  const auto system = [&](double growth) {
    return TMatrixSystem(placement, k, options.tolerance, options.sensors, growth);
  };
  const TMatrixSystem first = system(1);
  auto fields = fields_of(first, plan, options);
  if (!first.has_gap_plasmons()) return fields;
  double change = 0;
  for (const double growth : confirming_growths) {
    const auto before = std::exchange(fields, fields_of(system(growth), plan, options));
    change = relative_change(before, fields);
    if (change <= options.tolerance) return fields;
  }
  throw InputError(
      "tolerance", options.tolerance,
      "narrow gaps next to TE disks with Re(index^2) < 0 resonate: higher orders still "
      "change the fields by " +
          number_text(change) + "; widen the gap (min_gap) or allow a tolerance of this size");
}

void write_solution(ResultFile& file, const WaveSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec>& sensors) {
  write_light_axis(file, solution.light_angles());
  write_views(file, "far_field", solution, far_views(view_angles));
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
