#pragma once

#include <cstddef>
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

/// A matrix, column by column.
struct ColumnMajor {
  ColumnMajor(std::size_t r, std::size_t c) : rows(r), columns(c), data(r * c) {}
  std::size_t rows, columns;
  std::vector<Complex> data;
  Complex& operator()(std::size_t i, std::size_t j) { return data[i + rows * j]; }
  Complex* column(std::size_t j) { return data.data() + rows * j; }
};

using flatspeckle::product;  // of numbers, beside this one
ColumnMajor product(const ColumnMajor& a, const ColumnMajor& b);

/// 2-norms of columns of the given length.
std::vector<double> column_norms(std::span<const Complex> columns, std::size_t rows);

/// w = q s with orthonormal columns q, which replace w; directions below `drop` are left out.
ColumnMajor orthonormalize(ColumnMajor& w, double drop);

/// Orthonormal vectors that span a Krylov space, all blocks side by side.
class KrylovBasis {
 public:
  explicit KrylovBasis(std::size_t rows) : rows_(rows) {}
  std::size_t size() const { return data_.size() / rows_; }

  void append(const ColumnMajor& block);
  /// The last `count` vectors.
  std::span<const Complex> last(std::size_t count) const;
  /// Takes the part of w within the span out of it; returns its coefficients. The result does not
  /// depend on the number of threads.
  ColumnMajor project_out(ColumnMajor& w) const;
  /// Combination of the first y.rows vectors.
  ColumnMajor combine(const ColumnMajor& y) const;

 private:
  std::size_t rows_;
  std::vector<Complex> data_;
};

/// The least-squares problem min ||g - H y|| with H block upper Hessenberg, kept triangular by one
/// small Householder factorization a block column.
class HessenbergLeastSquares {
 public:
  explicit HessenbergLeastSquares(ColumnMajor g) : g_(std::move(g)) {}

  /// h: all of the next block column, the last `below` rows under its diagonal block.
  void append(ColumnMajor h, std::size_t below);
  /// What no y reaches, of each column of g.
  std::vector<double> residuals();
  /// Not finite where H is singular.
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
  std::vector<std::vector<Complex>> columns_;  // of the triangle
  std::vector<Reflection> steps_;
};

}  // namespace flatspeckle::wave
