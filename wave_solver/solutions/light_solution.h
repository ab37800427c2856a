#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/solutions/equation_solver.h"
#include "wave_solver/solutions/light_basis.h"

namespace flatspeckle::wave {

struct SolveOptions {
  /// Relative accuracy asked of far fields, and of near fields at `sensors`; sets the basis orders.
  double tolerance = 1e-12;
  std::vector<Vec2> sensors;
  /// Also estimate residual, condition and boundary residual.
  bool diagnose = true;
  Method method = Method::automatic;
};

/// How far a solution can be trusted; NaN-free, -1 where it was not asked for.
struct Diagnosis {
  /// ||b - T(a + S b)|| / ||T a||, over all lights (C10); of many an estimate (columns.h)
  double residual = -1;
  double condition = -1;          ///< of the scaled matrix, in the Frobenius norm (an estimate)
  double boundary_residual = -1;  ///< of the fields at the rims (wave_solution.cpp)
};

/// beta under unit plane waves.
struct LightSolution {
  std::vector<Complex> coefficients;  ///< [light][unknown]
  Diagnosis diagnosis;                ///< without the boundary residual
  std::string method;                 ///< in words
};

/// circle: that holds all bodies. Throws as EquationSolver does.
LightSolution solve_lights(const WaveEquations& equations, const std::vector<double>& light_angles,
                           const Circle& circle, const SolveOptions& options);

EquationSolver solver_of(const WaveEquations& equations, const SolveOptions& options);

/// Columns of the basis, n long, to those of all lights.
std::vector<Complex> expanded(const LightBasis& basis, std::vector<Complex> columns, std::size_t n);

}  // namespace flatspeckle::wave
