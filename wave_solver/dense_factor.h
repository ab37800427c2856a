#pragma once

#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "core/complex.h"

namespace flatspeckle::wave {

/// A complex symmetric system M x = b solved in the cheapest way that proves good:
///   mixed      L L^T in single precision, refined to double (many unknowns, few right sides);
///   symmetric  L L^T in double precision;
///   pivoted    LU with row exchanges.
/// The first that suits the numbers is tried, and left for the next where the backward error
/// |b - M x| / (|M| |x| + |b|), in the 2- and Frobenius norms, stays above 1e-14 after refinement:
/// pivots are not exchanged in L L^T, and single precision fails at conditions above about 1e6. It is
/// measured on all columns where they are refined, else on one combination of them all.
/// Cost: n^3/6 complex multiplications and as many additions, half of LU's.
class DenseFactor {
 public:
  enum class Method { mixed, symmetric, pivoted };

  /// matrix: both triangles, column-major.
  DenseFactor(std::vector<Complex> matrix, std::size_t unknowns);

  /// columns: [column][unknown]. May be called again; what was found out about methods is kept.
  /// Throws std::runtime_error if no method finds a finite solution of small backward error.
  std::vector<Complex> solve(const std::vector<Complex>& columns);

  Method method() const { return method_; }
  /// Condition number of M in the 1-norm, an estimate from below (Higham's, by LAPACK). After a solve.
  double condition() const;

 private:
  bool factor();
  void solve_once(std::vector<Complex>& x) const;
  std::vector<Complex> residual(const std::vector<Complex>& b, const std::vector<Complex>& x) const;
  double backward_error(const std::vector<Complex>& b, const std::vector<Complex>& x,
                        const std::vector<Complex>& r) const;
  bool is_good(const std::vector<Complex>& b, const std::vector<Complex>& x) const;
  bool refine(const std::vector<Complex>& b, std::vector<Complex>& x) const;
  std::vector<Complex> right_method(const std::vector<Complex>& b);

  std::size_t n_;
  Method method_ = Method::symmetric;
  bool factored_ = false;
  // M; its lower triangle and diagonal hold L once it is factored in double precision.
  std::vector<Complex> matrix_, diagonal_;
  std::vector<std::complex<float>> single_;  // L of mixed
  std::vector<Complex> lu_;
  std::vector<int> pivots_;
  double norm_ = 0;      // Frobenius
  double one_norm_ = 0;  // largest column
};

/// "single-precision L L^T, refined", and so on.
std::string describe(DenseFactor::Method method);

}  // namespace flatspeckle::wave
