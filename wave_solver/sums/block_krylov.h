#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// Linear map of blocks of columns, [column][unknown] to [column][unknown].
using BlockMap = std::function<std::vector<Complex>(std::span<const Complex>)>;

struct GmresOptions {
  double tolerance = 1e-10;  ///< largest accepted ||b - A x|| / ||b||
  int block = 16;            ///< number of right-hand sides that share one Krylov space
  int products = 2000;       ///< most steps for a block of right-hand sides, one product each
  double basis_bytes = 1e9;  ///< memory of the Krylov basis at which the method is restarted
  BlockMap preconditioner = nullptr;  ///< approximate A^-1, applied from the right
};

/// Solutions and residuals. A column that did not reach the tolerance contains the best
/// approximation.
struct GmresResult {
  std::vector<Complex> x;         ///< [column][unknown]
  std::vector<double> residuals;  ///< ||b - A x|| / ||b||, [column], computed from x; 0 if b = 0
  std::vector<int> steps;         ///< [column]: number of products with A for its block
  bool converged = true;          ///< all residuals are within the tolerance
};

/// Solves A x = b for all columns by restarted block GMRES: the right-hand sides of a block share
/// one Krylov space, from which linearly dependent directions are dropped. Stops with converged =
/// false if a restart reduces the residual by less than a factor of two or GmresOptions::products
/// is reached. See Saad, Iterative Methods, section 6.12.
[[nodiscard]] GmresResult gmres(const BlockMap& a, std::size_t unknowns,
                                std::span<const Complex> right_hand_sides,
                                const GmresOptions& options = {});

/// A column-major matrix.
struct ColumnMajor {
  ColumnMajor(std::size_t r, std::size_t c) : rows(r), columns(c), data(r * c) {}
  std::size_t rows, columns;
  std::vector<Complex> data;
  Complex& operator()(std::size_t i, std::size_t j) { return data[i + rows * j]; }
  Complex* column(std::size_t j) { return data.data() + rows * j; }
};

using flatspeckle::product;  // product of two numbers, overloaded below for matrices
ColumnMajor product(const ColumnMajor& a, const ColumnMajor& b);

/// Returns the 2-norms of columns of length `rows`.
std::vector<double> column_norms(std::span<const Complex> columns, std::size_t rows);

/// Factors w = q s, where q has orthonormal columns. Replaces w by q and returns s. Directions in
/// which w is smaller than `drop` are omitted.
ColumnMajor orthonormalize(ColumnMajor& w, double drop);

/// Orthonormal vectors that span a Krylov space, stored in the order in which they were appended.
class KrylovBasis {
 public:
  explicit KrylovBasis(std::size_t rows) : rows_(rows) {}
  std::size_t size() const { return data_.size() / rows_; }

  void append(const ColumnMajor& block);
  /// The last `count` vectors.
  std::span<const Complex> last(std::size_t count) const;
  /// Subtracts from w its projection onto the span and returns the coefficients of the projection.
  /// The result does not depend on the number of threads.
  ColumnMajor project_out(ColumnMajor& w) const;
  /// Returns linear combinations of the first y.rows vectors; each column of y contains the
  /// coefficients of one combination.
  ColumnMajor combine(const ColumnMajor& y) const;

 private:
  std::size_t rows_;
  std::vector<Complex> data_;
};

/// Least-squares problem min ||g - H y|| with H block upper Hessenberg, reduced to triangular form
/// by one small Householder factorization per block column.
class HessenbergLeastSquares {
 public:
  explicit HessenbergLeastSquares(ColumnMajor g) : g_(std::move(g)) {}

  /// Appends the next block column h of H, whose last `below` rows lie below its diagonal block.
  void append(ColumnMajor h, std::size_t below);
  /// Norm of the least-squares residual for each column of g.
  std::vector<double> residuals();
  /// Returns the minimising y; not finite if H is singular.
  ColumnMajor solution();

 private:
  struct Reflection {
    std::size_t top;
    ColumnMajor factor;
    std::vector<Complex> tau;
  };
  static void reflect(const Reflection& step, ColumnMajor& target);
  void grow(std::size_t rows);

  ColumnMajor g_;
  std::vector<std::vector<Complex>> columns_;  // columns of the triangular factor
  std::vector<Reflection> steps_;
};

}  // namespace flatspeckle::wave
