#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// A linear map of blocks of columns, [column][unknown] to the same.
using BlockMap = std::function<std::vector<Complex>(std::span<const Complex>)>;

struct GmresOptions {
  double tolerance = 1e-10;  ///< of every column's ||b - A x|| / ||b||
  int block = 16;            ///< right sides that share one Krylov space
  int products = 2000;       ///< steps given to a block at most; each is one product of a block
  double basis_bytes = 1e9;  ///< a space that would take more is restarted
  BlockMap preconditioner = nullptr;  ///< about A^-1, applied from the right
};

/// What became of each right side. A column that did not reach the tolerance is the best found.
struct GmresResult {
  std::vector<Complex> x;         ///< [column][unknown]
  std::vector<double> residuals;  ///< ||b - A x|| / ||b||, computed from x; 0 where b = 0
  std::vector<int> steps;         ///< products of its block
  bool converged = true;          ///< all residuals are within the tolerance
};

/// Solves A x = b for all columns by restarted block GMRES: a block's right sides search one space,
/// from which dependent directions are dropped. Stops with converged = false where a restart brings
/// less than a factor of two or the products are used up. Saad, Iterative Methods, 6.12.
[[nodiscard]] GmresResult gmres(const BlockMap& a, std::size_t unknowns,
                                std::span<const Complex> right_sides,
                                const GmresOptions& options = {});

}  // namespace flatspeckle::wave
