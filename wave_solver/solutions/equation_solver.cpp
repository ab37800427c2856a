#include "wave_solver/solutions/equation_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/contract.h"
#include "core/error.h"
#include "core/numbers/bessel.h"
#include "core/numbers/random.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/skeletons/fast_direct.h"
#include "wave_solver/spheres/sphere_equations.h"
#include "wave_solver/sums/block_krylov.h"
#include "wave_solver/sums/fast_product.h"
#include "wave_solver/sums/space_product.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t few = 8;  // up to this number of lights a LightBasis saves little

// Returns upper bounds of |J_n(k r)| within the circle k r <= x, for n = 0, 1, .. until they are
// negligible.
std::vector<double> wave_sizes(double x, double tolerance) {
  std::vector<double> sizes;
  const int start = static_cast<int>(std::ceil(x));
  const int reach = start + 40 + static_cast<int>(10 * std::cbrt(x));
  const auto j = bessel_j(reach, x);
  for (int n = 0; n <= reach; ++n) {
    sizes.push_back(n <= start ? 1 : static_cast<double>(std::abs(j[n])));
    if (n > start && sizes.back() < tolerance / 100) break;
  }
  return sizes;
}

// Returns the expansion coefficients of plane waves, sizes_n i^n e^{-i n angle} (wave_sizes()), as
// a column-major matrix with one row for each n = -M .. M and one column for each light.
std::vector<Complex> coefficients(std::span<const double> angles,
                                  const std::vector<double>& sizes) {
  const int most = static_cast<int>(sizes.size()) - 1;
  std::vector<Complex> matrix;
  for (double angle : angles)
    for (int n = -most; n <= most; ++n)
      matrix.push_back(std::polar(sizes[std::abs(n)], n * (std::acos(0.0) - angle)));
  return matrix;
}

bool is_source(const Light& light) {
  return light.kind == Light::Kind::point;
}

LightBasis source_basis(const Lights& lights) {
  LightBasis basis;
  for (const Light& light : lights) {
    if (!is_source(light))
      throw InputError(
          "near sources cannot be combined with plane waves or beams; solve for one kind at a "
          "time");
    basis.sources.push_back(light.point);
  }
  return basis;
}

// A plane wave that is part of a light.
struct Wave {
  double angle;
  Complex weight;
};
// Contribution of a plane wave to one of the lights (index `light`).
struct Part {
  std::size_t light;
  Complex weight;
};

// Expands a light in plane waves. A beam of waist w has at its focus the spectrum
//   w / (2 sqrt(pi)) exp(-q^2 w^2 / 4)
// of the transverse wavenumber q. Equal steps of q make the beam periodic across its axis; its
// periodic copies lie outside the circle.
std::vector<Wave> waves_of(const Light& light, double k, const Circle& circle, double tolerance) {
  if (light.kind == Light::Kind::plane) return {{light.angle, 1}};
  const Vec offset = circle.centre - light.point, axis = direction(light.angle);
  const double waist = light.waist, reach = length(offset) + circle.radius;
  const double width = waist * std::hypot(1, 2 * reach / (k * waist * waist));
  constexpr double negligible = 6;  // the field is negligible this many widths from the axis
  const double lateral = std::abs(offset.x * axis.z - offset.z * axis.x) + circle.radius;
  const double step = 2 * std::numbers::pi / (lateral + negligible * width);
  const double highest = std::min(0.999 * k, 2 / waist * std::sqrt(std::log(1e3 / tolerance)));
  const int count = static_cast<int>(highest / step);
  std::vector<Wave> waves;
  for (int n = -count; n <= count; ++n) {
    const double q = n * step, angle = light.angle + std::asin(q / k);
    const double size =
        step * waist / (2 * std::sqrt(std::numbers::pi)) * std::exp(-q * q * waist * waist / 4);
    waves.push_back({angle, std::polar(size, -k * dot(direction(angle), light.point))});
  }
  return waves;
}

constexpr double best_product = 1e-12;  // smallest tolerance of FastProduct
constexpr double rough_factor = 1e-6;   // smallest tolerance of FastDirect that saves time

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

}  // namespace

Circle enclosing_circle(const Placement& placement) {
  if (placement.empty()) return {};
  const Rectangle box = bounds_of(placement, &PlacedScatterer::position);
  Circle circle{0.5 * (box.low + box.high), 0};
  for (const auto& [r, scatterer] : placement)
    circle.radius = std::max(circle.radius, length(r - circle.centre) + scatterer.disk_radius());
  return circle;
}

LightBasis light_basis(std::span<const double> angles, double k, const Circle& circle,
                       double tolerance) {
  const LightBasis all{{angles.begin(), angles.end()}, {}, {}};
  const std::size_t lights = angles.size();
  if (lights <= few) return all;
  const auto sizes = wave_sizes(std::max(k * circle.radius, 1e-6), tolerance);
  auto matrix = coefficients(angles, sizes);
  const auto rows = static_cast<lapack_int>(matrix.size() / lights),
             columns = static_cast<lapack_int>(lights);
  std::vector<lapack_int> pivots(lights);
  std::vector<Complex> reflectors(lights);
  LAPACKE_zgeqp3(LAPACK_COL_MAJOR, rows, columns, matrix.data(), rows, pivots.data(),
                 reflectors.data());
  const auto diagonal = [&](lapack_int i) { return std::abs(matrix[i * (rows + 1)]); };
  lapack_int rank = 0;
  while (rank < std::min(rows, columns) && diagonal(rank) > tolerance) ++rank;
  if (10 * rank > 9 * columns) return all;
  // The omitted columns are the kept ones times R11^-1 R12.
  triangular_solve(CblasLeft, CblasUpper, CblasNoTrans, rank, columns - rank, matrix.data(), rows,
                   &matrix[rank * rows], rows);
  LightBasis basis;
  basis.weights.resize(lights * rank);
  const auto phase = [&](std::size_t light) {
    return std::polar(1.0, k * dot(direction(angles[light]), circle.centre));
  };
  for (lapack_int i = 0; i < columns; ++i) {
    const std::size_t light = pivots[i] - 1;
    if (i < rank) basis.angles.push_back(angles[light]);
    for (lapack_int j = 0; j < rank; ++j) {
      const Complex weight = i < rank ? Complex(i == j) : matrix[i * rows + j];
      basis.weights[light * rank + j] = weight * phase(light) * std::conj(phase(pivots[j] - 1));
    }
  }
  return basis;
}

LightBasis basis_of(const Lights& lights, double k, const Circle& circle, double tolerance) {
  if (std::any_of(lights.begin(), lights.end(), is_source)) return source_basis(lights);
  std::vector<double> angles;
  std::vector<Part> parts;
  for (std::size_t light = 0; light < lights.size(); ++light) {
    for (const auto& [angle, weight] : waves_of(lights[light], k, circle, tolerance)) {
      parts.push_back({light, weight});
      angles.push_back(angle);
    }
  }
  LightBasis basis = light_basis(angles, k, circle, tolerance);
  if (lights.all(Light::Kind::plane)) return basis;
  const std::size_t rank = basis.angles.size();
  std::vector<Complex> weights(lights.size() * rank);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Complex* const row = &weights[parts[p].light * rank];
    if (basis.weights.empty()) row[p] = parts[p].weight;
    for (std::size_t j = 0; j < rank && !basis.weights.empty(); ++j)
      row[j] += parts[p].weight * basis.weights[p * rank + j];
  }
  basis.weights = std::move(weights);
  return basis;
}

std::vector<Complex> expanded(const LightBasis& basis, std::vector<Complex> columns,
                              std::size_t n) {
  if (basis.weights.empty() || n == 0) return columns;
  std::vector<Complex> all(n * basis.count());
  multiply(CblasNoTrans, CblasNoTrans, n, basis.count(), basis.size(), 1, columns.data(), n,
           basis.weights.data(), basis.size(), 0, all.data(), n);
  return all;
}

// The tolerance is lower if there are sensors, because fields at the rims and inside disks amplify
// the residual of the equations.
EquationSolver solver_of(const WaveEquations& equations, const SolveOptions& options) {
  const Method method = options.method == Method::automatic
                            ? method_for(equations.unknowns(), options.tolerance)
                            : options.method;
  return {solvable(equations), method,
          options.sensors.empty() ? options.tolerance : options.tolerance / 10};
}

namespace {

double norm_of(const std::vector<Complex>& values) {
  double squares = 0;
  for (const Complex value : values) squares += std::norm(value);
  return std::sqrt(squares);
}

// Returns the relative change of far fields due to rounding. A relative rounding error e of a
// radius changes the diagonal of M by e |T|/T d ln T / d ln(radius); right-hand sides change by
// their own relative rounding error. To first order the solution changes by M^-1 times these
// changes. Only the first of the combinations() of solutions and right-hand sides is used.
double rounding_of(const WaveEquations& equations, EquationSolver& solver,
                   const std::vector<Complex>& rhs, const std::vector<Complex>& solution,
                   std::span<const Complex> radius_derivatives) {
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  const std::size_t n = equations.unknowns();
  if (n == 0 || rhs.empty()) return 0;
  RandomStream random(0, 0, 0);
  auto x = combinations(solution, n), changes = combinations(rhs, n);
  x.resize(n);
  changes.resize(n);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const double sign = random.uniform() < 0.5 ? -1 : 1;
    changes[i] =
        rounding * (sign * changes[i] + equations.diagonal(i) * radius_derivatives[i] * x[i]);
  }
  std::vector<double> angles;
  for (int i = 0; i < 16; ++i) angles.push_back(i * std::numbers::pi / 8);
  const auto rows = equations.far_rows(angles);
  const auto size = [&](const std::vector<Complex>& column) {
    return norm_of(transposed_product(rows, column.data(), 1, n));
  };
  const double whole = size(x);
  return whole > 0 ? size(solver.solve_roughly(std::move(changes))) / whole : 0;
}

}  // namespace

LightSolution solve_lights(const WaveEquations& equations, const std::vector<double>& light_angles,
                           const Circle& circle, const SolveOptions& options,
                           std::span<const Complex> radius_derivatives) {
  const auto basis = light_basis(light_angles, equations.k(), circle, options.tolerance);
  EquationSolver solver = solver_of(equations, options);
  const auto rhs = equations.right_hand_sides(basis.angles);
  LightSolution found{solver.solve(rhs, options.diagnose), {}, {}};
  if (options.diagnose) {
    // The unscaled equations are the scaled ones times the square roots of these weights.
    std::vector<double> weights;
    for (std::size_t i = 0; i < equations.unknowns(); ++i) weights.push_back(equations.strength(i));
    found.diagnosis.residual = relative_size(solver.combined_residual(), rhs, weights);
    found.diagnosis.condition = solver.condition();
  }
  found.method = solver.description();
  if (!radius_derivatives.empty())
    found.diagnosis.rounding = {
        rounding_of(equations, solver, rhs, found.coefficients, radius_derivatives),
        options.tolerance};
  found.coefficients = expanded(basis, std::move(found.coefficients), equations.unknowns());
  return found;
}

Method method_for(std::size_t unknowns, double tolerance) {
  const std::size_t dense_limit = tolerance < 1e-9 ? 5000 : 1500;
  return unknowns <= dense_limit ? Method::dense : Method::fast;
}

Method method_in_space(std::size_t unknowns, bool only_points) {
  return unknowns <= (only_points ? 3000 : 10000) ? Method::dense : Method::krylov;
}

SolvableEquations solvable(const WaveEquations& equations) {
  const auto* const of = &equations;
  return {equations.unknowns(), true, [of] { return of->matrix(); },
          [of](double tolerance) -> BlockMap {
            const auto product = std::make_shared<const FastProduct>(*of, tolerance);
            return [product](std::span<const Complex> x) { return (*product)(x); };
          },
          [of](double tolerance) -> BlockMap {
            const auto factor = std::make_shared<const FastDirect>(*of, tolerance);
            return [factor](std::span<const Complex> x) {
              std::vector<Complex> y(x.begin(), x.end());
              factor->solve(y);
              return y;
            };
          }};
}

SolvableEquations solvable(const SphereEquations& equations) {
  const auto* const of = &equations;
  return {equations.unknowns(), true, [of] { return of->matrix(); },
          [of](double tolerance) -> BlockMap {
            if (of->only_points()) {
              const auto product = std::make_shared<const SpaceProduct>(*of, tolerance);
              if (product->range() > 0)
                return [product](std::span<const Complex> x) { return (*product)(x); };
            }
            return [of](std::span<const Complex> x) { return of->apply(x); };
          }};
}

EquationSolver::EquationSolver(const WaveEquations& equations, Method method, double tolerance)
    : EquationSolver(
          solvable(equations),
          method == Method::automatic ? method_for(equations.unknowns(), tolerance) : method,
          tolerance) {}

EquationSolver::EquationSolver(const SolvableEquations& equations, Method method, double tolerance)
    : unknowns_(equations.unknowns), tolerance_(std::max(tolerance, best_product)) {
  FS_EXPECT(method != Method::automatic);
  if (method == Method::dense) {
    dense_ = std::make_unique<DenseFactor>(equations.matrix(), unknowns_, equations.symmetric);
    return;
  }
  product_ = equations.product(std::max(tolerance_ / 10, best_product));
  if (method == Method::fast) fast_ = equations.inverse(std::max(tolerance_ / 10, rough_factor));
}

EquationSolver::~EquationSolver() = default;

std::vector<Complex> EquationSolver::solve(const std::vector<Complex>& rhs, bool condition) {
  if (fast_)
    if (auto x = refined(rhs)) return std::move(*x);
  if (!dense_) return by_gmres(rhs);
  auto x = dense_->solve(rhs, condition);
  combined_residual_ = dense_->combined_residual();
  description_ = dense_->is_pivoted() ? "dense LU with pivoting" : "dense L L^T without pivoting";
  return x;
}

std::vector<Complex> EquationSolver::solve_roughly(std::vector<Complex> rhs) {
  return fast_ ? fast_(rhs) : solve(rhs);
}

// Solves with FastDirect and iterative refinement; nullopt if refinement does not converge.
// Right-hand sides are scaled to norm 1, so that none is negligible compared with others.
std::optional<std::vector<Complex>> EquationSolver::refined(std::vector<Complex> rhs) {
  const std::size_t n = unknowns_;
  auto norms = column_norms(rhs, n);
  std::replace(norms.begin(), norms.end(), 0.0, 1.0);
  for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] /= norms[i / n];
  const auto sums = combinations(rhs, n);
  auto x = fast_(rhs);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0;; ++step) {
    combined_residual_ = subtracted(sums, combinations(x, n));
    const double now = relative_size(combined_residual_, rhs, std::vector<double>(n, 1));
    description_ = "recursive skeletonization, refined " + std::to_string(step) +
                   " times, residual " + scientific(now);
    if (now <= tolerance_ / 2) break;
    if (!(now < before / 2)) return std::nullopt;
    before = now;
    const auto correction = fast_(subtracted(rhs, x));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += correction[i];
  }
  for (std::size_t i = 0; i < x.size(); ++i) x[i] *= norms[i / n];
  const double norm = root_mean_square(norms);
  for (Complex& left : combined_residual_) left *= norm;
  return x;
}

// Solves by GMRES. The preconditioner is FastDirect, if it was constructed (Method::fast).
std::vector<Complex> EquationSolver::by_gmres(const std::vector<Complex>& rhs) {
  GmresOptions options{.tolerance = tolerance_};
  options.preconditioner = fast_;
  auto result = gmres(product_, unknowns_, rhs, options);
  double worst = 0;
  for (double residual : result.residuals) worst = std::max(worst, residual);
  const int steps =
      result.steps.empty() ? 0 : *std::max_element(result.steps.begin(), result.steps.end());
  description_ = (fast_ ? "recursive skeletonization and block GMRES, " : "block GMRES, ") +
                 std::to_string(steps) + " fast products, residual " + scientific(worst);
  if (!(worst <= 100 * tolerance_))
    throw std::runtime_error("the multiple-scattering equations were not solved: " + description_ +
                             ", required " + scientific(tolerance_) +
                             (fast_ ? "" : "; use --solver fast, which is a direct method"));
  const std::size_t n = unknowns_;
  combined_residual_ = subtracted(combinations(rhs, n), combinations(result.x, n));
  return std::move(result.x);
}

// Returns b - M x.
std::vector<Complex> EquationSolver::subtracted(std::vector<Complex> b,
                                                const std::vector<Complex>& x) const {
  const auto y = product_(x);
  for (std::size_t i = 0; i < b.size(); ++i) b[i] -= y[i];
  return b;
}

double EquationSolver::condition() const {
  return dense_ ? dense_->condition() : -1;
}

}  // namespace flatspeckle::wave
