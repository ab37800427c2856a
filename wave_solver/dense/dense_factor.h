#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// Factors a complex symmetric (not Hermitian) matrix A = L L^T without pivoting. This is half the
/// work of LU, and nearly all of this work is in rank-k updates. Intended for matrices with a
/// positive semidefinite real part, such as those of passive scatterers (TMatrixSystem). Schur
/// complements also have this property, so that no pivot vanishes. Element growth is bounded only
/// if the real part is well conditioned [golub1979]; callers check a residual.
///
/// a: column-major with leading dimension ld; its lower triangle is replaced by L, the strict upper
/// triangle is unchanged. Returns false if a pivot is 0 or not finite.
bool factor_symmetric(Complex* a, std::size_t n, std::size_t ld);

/// Replaces X by L^-1 X. X is column-major with n rows.
void solve_forward(const Complex* l, std::size_t n, std::size_t ld, Complex* x, std::size_t columns,
                   std::size_t ldx);
/// Replaces X by L^-T X.
void solve_backward(const Complex* l, std::size_t n, std::size_t ld, Complex* x,
                    std::size_t columns, std::size_t ldx);

/// Returns four linear combinations of all columns (of length n) with random phases as
/// coefficients, or the columns themselves if there are at most four. The mean squared error of the
/// combinations estimates the sum of the squared errors of all columns.
std::vector<Complex> combinations(const std::vector<Complex>& columns, std::size_t n);

/// Estimates sqrt(sum w |r|^2 / sum w |b|^2). The sums run over the rows of all right-hand sides b
/// and of their residuals r, with the weight w of each row. combined_r: combinations() of the
/// residuals. weights: w.
double relative_size(const std::vector<Complex>& combined_r, const std::vector<Complex>& b,
                     const std::vector<double>& weights);

/// Returns a^T b of matrices with n rows: [column of b][column of a].
std::vector<Complex> transposed_product(const std::vector<Complex>& a, const Complex* b,
                                        std::size_t columns_b, std::size_t n);

/// Throws std::runtime_error if a value is infinite or not a number.
void require_finite(std::span<const Complex> values);

/// Allocator that does not set the elements of a new vector to 0. It is intended for vectors whose
/// elements are all written before they are read.
template <typename Number>
struct Unset : std::allocator<Number> {
  Unset() = default;
  template <typename Other>
  Unset(const Unset<Other>&) {}
  template <typename Other>
  struct rebind {
    using other = Unset<Other>;
  };

  void construct(Number*) const {}
  template <typename... Values>
  void construct(Number* at, Values&&... values) const {
    std::construct_at(at, std::forward<Values>(values)...);
  }
};

/// Elements of a matrix, column by column; not initialised on creation.
using Entries = std::vector<Complex, Unset<Complex>>;

/// Solver of a complex symmetric system M x = b: L L^T without pivoting, or LU with row exchanges
/// if M is not symmetric or if L L^T leaves a backward error |b - M x| / (|M| |x| + |b|) above
/// 1e-14 after refinement. Vectors are measured by the 2-norm, M by the Frobenius norm. The
/// backward error is measured on combinations() of the columns; during refinement it is the largest
/// of all columns.
///
/// Cost of L L^T: n^3/6 complex multiplications and as many additions, half of the cost of LU. For
/// the points and disks of this module L L^T takes 0.51 of the time of LAPACK's zgetrf (LAPACK's
/// zsytrf takes 0.59 of it). Single precision with refinement was tried and rejected. With
/// condition numbers of 1e4 to 1e6, single precision needs many refinement steps, so that it saved
/// no time at n = 1000 and 2000, and only a quarter at n = 4000 with two right-hand sides.
class DenseFactor {
 public:
  /// matrix: both triangles, column-major.
  DenseFactor(Entries matrix, std::size_t unknowns, bool symmetric = true);

  /// Solves for columns of right-hand sides, [column][unknown]. condition: whether to estimate the
  /// condition number as well, at the cost of a few more columns. Throws std::runtime_error if no
  /// finite solution with a small backward error is found.
  std::vector<Complex> solve(const std::vector<Complex>& columns, bool condition = false);

  /// Whether LU with row exchanges was used.
  bool is_pivoted() const { return pivoted_; }
  /// Residual B - M X of the last solve, for combinations() of its right-hand sides B and solutions
  /// X.
  const std::vector<Complex>& combined_residual() const { return combined_residual_; }
  /// Estimated condition number of M in the Frobenius norm, which is at least the condition number
  /// in the 2-norm. Four random vectors determine it within a factor of about two [kenney1994].
  /// Refers to the last solve() with condition = true.
  double condition() const { return condition_; }

 private:
  std::vector<Complex> attempt(const std::vector<Complex>& b, bool condition);
  void take_condition(std::vector<Complex>& x);
  bool factor_pivoted();
  void solve_once(std::vector<Complex>& x) const;
  std::vector<Complex> residual(const std::vector<Complex>& b, const std::vector<Complex>& x) const;
  double backward_error(const std::vector<Complex>& b, const std::vector<Complex>& x,
                        const std::vector<Complex>& r) const;
  bool is_good(const std::vector<Complex>& b, const std::vector<Complex>& x);
  bool refine(const std::vector<Complex>& b, std::vector<Complex>& x) const;

  std::size_t n_;
  // The strict upper triangle contains M, the rest contains L. If LU with row exchanges was used,
  // the diagonal also contains M. If M is not symmetric, all of it is contained.
  Entries matrix_;
  std::vector<Complex> diagonal_;  // diagonal of M
  std::vector<Complex> lu_;
  std::vector<Complex> combined_residual_;
  std::vector<int> pivots_;
  double norm_ = 0;  // Frobenius norm of M
  double condition_ = 1;
  bool symmetric_ = true, factored_ = false, pivoted_ = false;
};

}  // namespace flatspeckle::wave
