#include "wave_solver/solutions/light_solution.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/columns.h"

namespace flatspeckle::wave {

std::vector<Complex> expanded(const LightBasis& basis, std::vector<Complex> columns,
                              std::size_t n) {
  if (basis.weights.empty() || n == 0) return columns;
  std::vector<Complex> all(n * basis.count());
  multiply(CblasNoTrans, CblasNoTrans, n, basis.count(), basis.size(), 1, columns.data(), n,
           basis.weights.data(), basis.size(), 0, all.data(), n);
  return all;
}

// Fields at the rims and inside of disks amplify what is left of the equations.
EquationSolver solver_of(const WaveEquations& equations, const SolveOptions& options) {
  const Method method = options.method == Method::automatic
                            ? method_for(equations.unknowns(), options.tolerance)
                            : options.method;
  return {equations, method, options.sensors.empty() ? options.tolerance : options.tolerance / 10};
}

LightSolution solve_lights(const WaveEquations& equations, const std::vector<double>& light_angles,
                           const Circle& circle, const SolveOptions& options) {
  const auto basis = light_basis(light_angles, equations.k(), circle, options.tolerance);
  EquationSolver solver = solver_of(equations, options);
  const auto sides = equations.right_sides(basis.angles);
  LightSolution found{solver.solve(sides, options.diagnose), {}, {}};
  if (options.diagnose) {
    std::vector<double> weights;  // those times their roots are rows of the unscaled equations
    for (std::size_t i = 0; i < equations.unknowns(); ++i) weights.push_back(equations.strength(i));
    found.diagnosis = {relative_size(solver.remainder(), sides, weights), solver.condition(), -1};
  }
  found.coefficients = expanded(basis, std::move(found.coefficients), equations.unknowns());
  found.method = solver.description();
  return found;
}

}  // namespace flatspeckle::wave
