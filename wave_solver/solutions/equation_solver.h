#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
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

}  // namespace flatspeckle::wave
