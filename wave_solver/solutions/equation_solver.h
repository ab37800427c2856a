#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/invariant.h"
#include "flatland/media/domain.h"
#include "flatland/placement/placement.h"
#include "flatland/request/light.h"
#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/sums/block_krylov.h"

namespace flatspeckle::wave {

class DenseFactor;
class SphereEquations;

/// Method that solves the equations. `dense` factors the matrix. `fast` uses recursive
/// skeletonization (FastDirect), refined with FastProduct. `krylov` uses GMRES with FastProduct
/// alone, which is suitable for weak scattering.
enum class Method { automatic, dense, fast, krylov };

/// Returns the method that `automatic` selects. The fast method is quicker from about 1000 unknowns
/// on. The dense method reaches residuals at the level of rounding and estimates the condition
/// number. If the tolerance is small, the dense method is therefore used up to a larger number of
/// unknowns.
Method method_for(std::size_t unknowns, double tolerance);

/// Returns the same for scatterers in space, for which there is no fast method. The iterative
/// method is quicker from about 3000 points on. For spheres, whose translations are expensive, it
/// is used from 10000 unknowns on, because of the memory of the matrix.
Method method_in_space(std::size_t unknowns, bool only_points);

/// Equations M beta = r, as EquationSolver uses them. The functions
/// refer to the equations from which they were made.
struct SolvableEquations {
  std::size_t unknowns = 0;
  bool symmetric = true;  ///< whether M is complex symmetric, which `inverse` may require
  std::function<Entries()> matrix;
  /// Returns the product with M, whose error is below `tolerance` times ||M x||.
  std::function<BlockMap(double tolerance)> product;
  /// Returns approximately M^-1; null if there is no fast direct method.
  std::function<BlockMap(double tolerance)> inverse = nullptr;
};
SolvableEquations solvable(const WaveEquations& equations);
SolvableEquations solvable(const SphereEquations& equations);

/// Solver of M beta = r, factored once for many right-hand sides.
class EquationSolver {
 public:
  /// tolerance: required residual of the methods fast and krylov, at least 1e-12. The residual of
  /// the method dense is always at the level of rounding. Throws InputError if memory does not
  /// suffice.
  EquationSolver(const SolvableEquations& equations, Method method, double tolerance);
  EquationSolver(const WaveEquations& equations, Method method, double tolerance);
  ~EquationSolver();

  /// Solves for right-hand sides rhs, [column][unknown]. condition: whether to estimate the
  /// condition number as well, if the method can. Throws std::runtime_error if no finite solution
  /// is found, or if a residual exceeds the tolerance by more than a factor of 100.
  std::vector<Complex> solve(const std::vector<Complex>& rhs, bool condition = false);
  /// Solves with a relative error of at most about 1 %. The method fast omits refinement, which
  /// saves time.
  std::vector<Complex> solve_roughly(std::vector<Complex> rhs);

  /// Residual of the last solve, for combinations() of its right-hand sides and solutions. It is
  /// computed with the fast product or, for method dense, with the matrix that was factored.
  const std::vector<Complex>& combined_residual() const { return combined_residual_; }
  /// Estimated condition number in the Frobenius norm, from the last solve() with condition = true;
  /// -1 for methods that do not estimate it.
  double condition() const;
  /// Description of the method, steps and residual of the last solution.
  const std::string& description() const { return description_; }

 private:
  std::optional<std::vector<Complex>> refined(std::vector<Complex> rhs);
  std::vector<Complex> by_gmres(const std::vector<Complex>& rhs);
  std::vector<Complex> subtracted(std::vector<Complex> b, const std::vector<Complex>& x) const;

  std::size_t unknowns_;
  double tolerance_;
  std::unique_ptr<DenseFactor> dense_;
  BlockMap fast_ = nullptr, product_ = nullptr;
  std::vector<Complex> combined_residual_;
  std::string description_;
};

/// Basis of many plane waves: a few of these waves, chosen so that, within a circle of radius R,
/// all others are linear combinations of them. The size of the basis is at most about 2 k R + 50
/// for any number of lights, and less for a narrow range of angles.
struct LightBasis {
  std::vector<double> angles;
  /// Coefficients of each light, [light][basis wave]; empty if every light is in the basis.
  std::vector<Complex> weights;
  std::vector<Vec> sources;  ///< point sources; if there are any, angles is empty

  std::size_t size() const { return angles.size() + sources.size(); }
  /// Number of the lights that the basis represents.
  std::size_t count() const { return weights.empty() ? size() : weights.size() / size(); }
};

struct Circle {
  Vec centre;
  double radius = 0;
};

/// Returns a circle that encloses all points and disks, rims included.
Circle enclosing_circle(const Placement& placement);

/// Chooses a basis by column-pivoted QR of the waves' Bessel coefficients on the circle; the
/// coefficients J_n(k R) decay for n > k R. The error is below tolerance relative to a unit wave.
/// Returns all lights as basis if a smaller basis would save little.
LightBasis light_basis(std::span<const double> angles, double k, const Circle& circle,
                       double tolerance);
/// Returns a basis of arbitrary lights. A Gaussian beam is the superposition of propagating plane
/// waves that has the beam's field across its focus; evanescent waves are omitted. Throws
/// InputError if point sources are mixed with other lights.
LightBasis basis_of(const Lights& lights, double k, const Circle& circle, double tolerance);

struct SolveOptions {
  /// Relative accuracy of far fields, and of near fields at `sensors`; determines the basis orders.
  double tolerance = 1e-12;
  std::vector<Vec> sensors;
  /// Whether to compute the Diagnosis: residual, condition number, boundary residual and
  /// invariants.
  bool diagnose = true;
  Method method = Method::automatic;
};

/// Error measures of a solution. They are never NaN. A measure that was not requested is -1.
struct Diagnosis {
  /// Residual ||b - T(a + S b)|| / ||T a|| over all lights (C10). For many lights it is an
  /// estimate.
  double residual = -1;
  double condition = -1;          ///< estimated condition number of the scaled matrix (Frobenius)
  double boundary_residual = -1;  ///< mismatch of the fields at rims (boundary_residual.h)
  /// Relative change of the fields when the basis orders are raised, measured if gap plasmons may
  /// resonate. The limit of `truncation` and of `rounding` is the tolerance.
  Invariant truncation = {};
  /// Relative change of the far fields if radii and right-hand sides change by a rounding error.
  Invariant rounding = {};
  Invariant power = {};  ///< power balance (solution_invariants.h)

  bool keeps_invariants() const { return truncation.holds() && rounding.holds() && power.holds(); }
};

/// Solution beta of WaveEquations under unit plane waves.
struct LightSolution {
  std::vector<Complex> coefficients;  ///< beta, [light][unknown]
  Diagnosis diagnosis;                ///< only residual, condition and rounding are set
  std::string method;                 ///< description of the method used
};

/// Solves for unit plane waves. circle: a circle that encloses all bodies. radius_derivatives: d ln
/// T / d ln(radius) of each unknown (TMatrixSystem); if given, the sensitivity to rounding is
/// measured. Throws under the conditions of EquationSolver.
LightSolution solve_lights(const WaveEquations& equations, const std::vector<double>& light_angles,
                           const Circle& circle, const SolveOptions& options,
                           std::span<const Complex> radius_derivatives = {});

/// Returns a solver with the method and tolerance that the options select.
EquationSolver solver_of(const WaveEquations& equations, const SolveOptions& options);

/// Computes the solutions (columns of length n) for all lights from the solutions for the basis.
std::vector<Complex> expanded(const LightBasis& basis, std::vector<Complex> columns, std::size_t n);

}  // namespace flatspeckle::wave
