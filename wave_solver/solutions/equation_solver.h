#pragma once

#include <cstddef>
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

namespace flatspeckle::wave {

class DenseFactor;
class FastDirect;
class FastProduct;

/// How the equations are solved: `dense` by a factored matrix, `fast` by recursive skeletonization,
/// refined with the fast product, `krylov` by GMRES with that product alone (weak scattering).
enum class Method { automatic, dense, fast, krylov };

/// What `automatic` means. The fast method is quicker from about 1000 unknowns on; the dense one
/// leaves residuals of rounding and tells the condition, and is kept for longer where that is
/// asked.
Method method_for(std::size_t unknowns, double tolerance);

/// M beta = r, factored once for many right sides.
class EquationSolver {
 public:
  /// Keeps a reference to the system. tolerance: asked of the residual of fast and krylov, from
  /// 1e-12 on; dense leaves that of rounding. Throws InputError where memory does not suffice.
  EquationSolver(const WaveEquations& system, Method method, double tolerance);
  ~EquationSolver();

  /// sides: [column][unknown]; condition: also estimate it, where the method can. Throws
  /// std::runtime_error where no finite solution is found, or a residual stays more than a hundred
  /// times above the tolerance.
  std::vector<Complex> solve(const std::vector<Complex>& sides, bool condition = false);
  /// Solves them to two digits and more, where the method has such a solution that costs less.
  std::vector<Complex> solve_roughly(std::vector<Complex> sides);

  /// What is left of the last sides, by combinations() of them; by the fast product or, where the
  /// method is dense, by the matrix that was factored.
  const std::vector<Complex>& remainder() const { return remainder_; }
  /// In the Frobenius norm, an estimate; -1 for methods that do not tell. Of the last solve that
  /// was asked for it.
  double condition() const;
  /// What was done, in words.
  const std::string& description() const { return description_; }

 private:
  std::optional<std::vector<Complex>> refined(std::vector<Complex> sides);
  std::vector<Complex> by_gmres(const std::vector<Complex>& sides);
  std::vector<Complex> subtracted(std::vector<Complex> b, const std::vector<Complex>& x) const;

  const WaveEquations& system_;
  double tolerance_;
  std::unique_ptr<DenseFactor> dense_;
  std::unique_ptr<FastDirect> fast_;
  std::unique_ptr<FastProduct> product_;
  std::vector<Complex> remainder_;
  std::string description_;
};

/// A few of many plane waves, of which the others are combinations within a circle: never more than
/// about 2 k R + 50, however many lights there are, and fewer where they come from a narrow range.
struct LightBasis {
  std::vector<double> angles;
  std::vector<Complex> weights;  ///< [light][basis]; empty where every light stands for itself
  std::vector<Vec2> sources;     ///< point sources, which have no plane waves beside them

  std::size_t size() const { return angles.size() + sources.size(); }
  /// Of the lights that it stands for.
  std::size_t count() const { return weights.empty() ? size() : weights.size() / size(); }
};

struct Circle {
  Vec2 centre;
  double radius = 0;
};

/// Around the rims of all disks.
Circle enclosing_circle(const Placement& placement);

/// Column-pivoted QR of the waves' Bessel coefficients on the circle (J_n decays beyond k R); what
/// it leaves out is below tolerance of a unit wave. Falls back to all lights where that saves
/// little.
LightBasis light_basis(std::span<const double> angles, double k, const Circle& circle,
                       double tolerance);
/// Of any lights: a Gaussian beam is the superposition of plane waves that has the beam's field
/// across its focus, but for what does not propagate. Throws InputError for point sources mixed
/// with others.
LightBasis basis_of(const Lights& lights, double k, const Circle& circle, double tolerance);

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
  /// ||b - T(a + S b)|| / ||T a||, over all lights (C10); of many an estimate
  double residual = -1;
  double condition = -1;          ///< of the scaled matrix, in the Frobenius norm (an estimate)
  double boundary_residual = -1;  ///< of the fields at the rims (boundary_residual.h)
  /// Relative change of the fields from lower orders, where gap plasmons may resonate. The limit of
  /// this and of the next is the tolerance.
  Invariant truncation = {};
  /// Relative change of the far fields where radii and sides change by a rounding.
  Invariant rounding = {};
  Invariant power = {};  ///< solution_invariants.h

  bool keeps_invariants() const { return truncation.holds() && rounding.holds() && power.holds(); }
};

/// beta under unit plane waves.
struct LightSolution {
  std::vector<Complex> coefficients;  ///< [light][unknown]
  Diagnosis diagnosis;                ///< without the boundary residual
  std::string method;                 ///< in words
};

/// circle: that holds all bodies. radius_derivatives: of the logarithm of each unknown's T-matrix
/// element by that of the radius (TMatrixSystem); where given, rounding is measured. Throws as
/// EquationSolver does.
LightSolution solve_lights(const WaveEquations& equations, const std::vector<double>& light_angles,
                           const Circle& circle, const SolveOptions& options,
                           std::span<const Complex> radius_derivatives = {});

EquationSolver solver_of(const WaveEquations& equations, const SolveOptions& options);

/// Columns of the basis, n long, to those of all lights.
std::vector<Complex> expanded(const LightBasis& basis, std::vector<Complex> columns, std::size_t n);

}  // namespace flatspeckle::wave
