#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// A = L L^T of a complex symmetric (not Hermitian) matrix without pivoting: half the work of LU,
/// nearly all of it in rank-k updates. Meant for matrices whose real part is positive semidefinite,
/// as those of passive scatterers are (TMatrixSystem): every Schur complement is of that kind
/// again, so that no pivot vanishes. Element growth is bounded only where the real part is well
/// conditioned (Golub and Van Loan 1979); callers check a residual.
///
/// a: column-major with leading dimension ld; its lower triangle becomes L, the strict upper one is
/// left alone. False if a pivot is 0 or not finite.
bool factor_symmetric(Complex* a, std::size_t n, std::size_t ld);

/// X <- L^-1 X, X column-major of n rows.
void solve_forward(const Complex* l, std::size_t n, std::size_t ld, Complex* x, std::size_t columns,
                   std::size_t ldx);
/// X <- L^-T X
void solve_backward(const Complex* l, std::size_t n, std::size_t ld, Complex* x,
                    std::size_t columns, std::size_t ldx);

/// Sums of all columns, of length n, with random phases, four of them, or the columns themselves
/// where they are fewer: the mean square of what is wrong in the sums is what is wrong in all
/// columns, in sum.
std::vector<Complex> combinations(const std::vector<Complex>& columns, std::size_t n);

/// sqrt(sum w |r|^2 / sum w |b|^2) over all columns b, what is left of them, r, being told by
/// combinations(). weights: [row]
double relative_size(const std::vector<Complex>& combined_r, const std::vector<Complex>& b,
                     const std::vector<double>& weights);

/// a^T b of matrices with n rows, columns by columns: [column of b][column of a].
std::vector<Complex> transposed_product(const std::vector<Complex>& a, const Complex* b,
                                        std::size_t columns_b, std::size_t n);

/// Throws std::runtime_error where a value is infinite or not a number.
void require_finite(std::span<const Complex> values);

/// Allocator of a vector whose elements are written before they are read: they are not set to 0
/// when it is made with a size.
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

/// Of a matrix that is filled by whoever makes it, column by column.
using Entries = std::vector<Complex, Unset<Complex>>;

/// A complex symmetric system M x = b: L L^T without pivoting, or LU with row
/// exchanges where that leaves a backward error |b - M x| / (|M| |x| + |b|) above 1e-14 after
/// refinement. It is measured in the 2- and Frobenius norms on combinations of all columns
/// (in columns), or on each where they are refined.
///
/// Cost: n^3/6 complex multiplications and as many additions, half of LU's. For the points and
/// disks of this room that is 0.51 of LAPACK's zgetrf (zsytrf: 0.59). Single precision with
/// refinement was tried and left out: conditions of 1e4 to 1e6 cost it so many residuals that it
/// gained nothing at n = 1000 and 2000, and a quarter at n = 4000 with two right sides.
class DenseFactor {
 public:
  /// matrix: both triangles, column-major.
  DenseFactor(Entries matrix, std::size_t unknowns);

  /// columns: [column][unknown]; condition: also estimate it, beside them, for a few columns
  /// more. Throws std::runtime_error if no finite solution of small backward error is found.
  std::vector<Complex> solve(const std::vector<Complex>& columns, bool condition = false);

  /// Whether rows had to be exchanged.
  bool is_pivoted() const { return pivoted_; }
  /// B - M X of combinations of the last columns B and their solution X.
  const std::vector<Complex>& remainder() const { return remainder_; }
  /// Condition number of M in the Frobenius norm, about: at least that in the 2-norm. Four random
  /// vectors tell it within a factor of two or so (Kenney and Laub 1994). Of the last solve that
  /// was asked for it.
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
  // The strict upper triangle is M's; the rest is L, or what is left of it once rows were
  // exchanged.
  Entries matrix_;
  std::vector<Complex> diagonal_;  // of M
  std::vector<Complex> lu_;
  std::vector<Complex> remainder_;
  std::vector<int> pivots_;
  double norm_ = 0;  // Frobenius
  double condition_ = 1;
  bool factored_ = false, pivoted_ = false;
};

}  // namespace flatspeckle::wave
