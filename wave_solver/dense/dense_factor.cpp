#include "wave_solver/dense/dense_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/numbers/random.h"
#include "core/run/interrupt.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

// Factors a small matrix column by column, without BLAS.
bool factor_small(Complex* a, std::size_t n, std::size_t ld) {
  for (std::size_t j = 0; j < n; ++j) {
    Complex* column = a + j * ld;
    const Complex pivot = std::sqrt(column[j]);
    if (!(std::norm(pivot) > 0) || !std::isfinite(std::norm(pivot))) return false;
    column[j] = pivot;
    const Complex inverse = 1.0 / pivot;
    for (std::size_t i = j + 1; i < n; ++i) column[i] = product(column[i], inverse);
    for (std::size_t l = j + 1; l < n; ++l)
      for (std::size_t i = l; i < n; ++i) a[l * ld + i] -= product(column[l], column[i]);
  }
  return true;
}

constexpr std::size_t small = 48, block = 96, strip = 384;

// Factors a diagonal block, which is halved recursively down to the size `small`, so that BLAS can
// also be used within the block.
bool factor_block(Complex* a, std::size_t n, std::size_t ld) {
  if (n <= small) return factor_small(a, n, ld);
  const std::size_t half = n / 2;
  if (!factor_block(a, half, ld)) return false;
  triangular_solve(CblasRight, CblasLower, CblasTrans, n - half, half, a, ld, a + half, ld);
  subtract_square(n - half, half, a + half, a + half * (ld + 1), ld);
  return factor_block(a + half * (ld + 1), n - half, ld);
}

// Subtracts W W^T from the lower triangle of C, one strip of columns at a time. Blocks below the
// diagonal blocks are updated by subtract_product(), with three real products instead of four.
void subtract_in_strips(std::size_t n, std::size_t depth, const Complex* w, Complex* c,
                        std::size_t ld) {
  for (std::size_t first = 0; first < n; first += strip) {
    const std::size_t size = std::min(strip, n - first), end = first + size;
    subtract_square(size, depth, w + first, c + first * (ld + 1), ld);
    if (end < n)
      subtract_product(n - end, size, depth, w + end, w + first, c + first * ld + end, ld);
  }
}

double weighted_square(const std::vector<double>& weights, const std::vector<Complex>& columns) {
  double sum = 0;
  for (std::size_t start = 0; start < columns.size(); start += weights.size())
    for (std::size_t i = 0; i < weights.size(); ++i)
      sum += weights[i] * std::norm(columns[start + i]);
  return sum;
}

constexpr double good = 1e-14;  // largest accepted backward error
constexpr std::size_t probes = 4;

double squared_norm(const Complex* values, std::size_t n) {
  const auto* parts = reinterpret_cast<const double*>(values);
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (std::size_t i = 0; i < 2 * n; ++i) sum += parts[i] * parts[i];
  return sum;
}

// Returns the Frobenius norm of a symmetric matrix, of which only the lower triangle is read.
double frobenius_norm(const Entries& symmetric, std::size_t n) {
  double square = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const Complex* const diagonal = &symmetric[j * (n + 1)];
    square += std::norm(*diagonal) + 2 * squared_norm(diagonal + 1, n - j - 1);
  }
  return std::sqrt(square);
}

void append_probes(std::vector<Complex>& columns, std::size_t n) {
  RandomStream random(0, 0, 0);
  columns.reserve(columns.size() + probes * n);
  for (std::size_t i = 0; i < probes * n; ++i)
    columns.push_back(std::polar(1.0, 2 * std::numbers::pi * random.uniform()));
}

}  // namespace

bool factor_symmetric(Complex* a, std::size_t n, std::size_t ld) {
  blas_single_thread();
  for (std::size_t first = 0; first < n; first += block) {
    stop_if_interrupted();
    const std::size_t size = std::min(block, n - first), rest = n - first - size;
    Complex* corner = a + first * (ld + 1);
    if (!factor_block(corner, size, ld)) return false;
    if (rest == 0) break;
    triangular_solve(CblasRight, CblasLower, CblasTrans, rest, size, corner, ld, corner + size, ld);
    subtract_in_strips(rest, size, corner + size, corner + size * (ld + 1), ld);
  }
  return true;
}

void solve_forward(const Complex* l, std::size_t n, std::size_t ld, Complex* x, std::size_t columns,
                   std::size_t ldx) {
  if (n > 0 && columns > 0)
    triangular_solve(CblasLeft, CblasLower, CblasNoTrans, n, columns, l, ld, x, ldx);
}

void solve_backward(const Complex* l, std::size_t n, std::size_t ld, Complex* x,
                    std::size_t columns, std::size_t ldx) {
  if (n > 0 && columns > 0)
    triangular_solve(CblasLeft, CblasLower, CblasTrans, n, columns, l, ld, x, ldx);
}

std::vector<Complex> combinations(const std::vector<Complex>& columns, std::size_t n) {
  constexpr std::size_t sums = 4;
  if (n == 0 || columns.size() <= sums * n) return columns;
  const std::size_t count = columns.size() / n;
  RandomStream random(0, 0, 0);
  std::vector<Complex> phases(count * sums), combined(n * sums);
  for (Complex& phase : phases) phase = std::polar(1.0, 2 * std::numbers::pi * random.uniform());
  multiply(CblasNoTrans, CblasNoTrans, n, sums, count, 1, columns.data(), n, phases.data(), count,
           0, combined.data(), n);
  return combined;
}

double relative_size(const std::vector<Complex>& combined_r, const std::vector<Complex>& b,
                     const std::vector<double>& weights) {
  const double given = weighted_square(weights, b);
  if (!(given > 0)) return 0;
  const bool all = combined_r.size() == b.size();
  const double sums = all ? 1 : static_cast<double>(combined_r.size() / weights.size());
  return std::sqrt(weighted_square(weights, combined_r) / sums / given);
}

void require_finite(std::span<const Complex> values) {
  for (const Complex& value : values)
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag()))
      throw std::runtime_error("the multiple-scattering equations have no finite solution");
}

std::vector<Complex> transposed_product(const std::vector<Complex>& a, const Complex* b,
                                        std::size_t columns_b, std::size_t n) {
  if (n == 0) return {};
  const std::size_t columns_a = a.size() / n;
  std::vector<Complex> result(columns_b * columns_a);
  if (result.empty()) return result;
  multiply(CblasTrans, CblasNoTrans, columns_a, columns_b, n, 1, a.data(), n, b, n, 0,
           result.data(), columns_a);
  return result;
}

DenseFactor::DenseFactor(Entries matrix, std::size_t unknowns, bool symmetric)
    : n_(unknowns), matrix_(std::move(matrix)), diagonal_(unknowns), symmetric_(symmetric) {
  blas_single_thread();
  for (std::size_t j = 0; j < n_; ++j) diagonal_[j] = matrix_[j * (n_ + 1)];
  norm_ = symmetric ? frobenius_norm(matrix_, n_)
                    : std::sqrt(squared_norm(matrix_.data(), matrix_.size()));
  if (!std::isfinite(norm_))
    throw std::runtime_error("the multiple-scattering equations are not finite");
  factored_ = symmetric ? factor_symmetric(matrix_.data(), n_, n_) : factor_pivoted();
}

bool DenseFactor::factor_pivoted() {
  const auto n = static_cast<lapack_int>(n_);
  lu_.assign(matrix_.begin(), matrix_.end());
  for (std::size_t j = 0; symmetric_ && j < n_; ++j) {
    lu_[j * (n_ + 1)] = matrix_[j * (n_ + 1)] = diagonal_[j];
    for (std::size_t i = 0; i < j; ++i) lu_[j * n_ + i] = lu_[i * n_ + j] = matrix_[j * n_ + i];
  }
  pivots_.resize(n_);
  pivoted_ = true;
  return LAPACKE_zgetrf(LAPACK_COL_MAJOR, n, n, lu_.data(), n, pivots_.data()) == 0;
}

void DenseFactor::solve_once(std::vector<Complex>& x) const {
  const std::size_t columns = x.size() / n_;
  if (pivoted_) {
    const auto n = static_cast<lapack_int>(n_);
    LAPACKE_zgetrs(LAPACK_COL_MAJOR, 'N', n, static_cast<lapack_int>(columns), lu_.data(), n,
                   pivots_.data(), x.data(), n);
  } else {
    solve_forward(matrix_.data(), n_, n_, x.data(), columns, n_);
    solve_backward(matrix_.data(), n_, n_, x.data(), columns, n_);
  }
}

// Computes B - M X. M is in the strict upper triangle of matrix_ and in diagonal_.
std::vector<Complex> DenseFactor::residual(const std::vector<Complex>& b,
                                           const std::vector<Complex>& x) const {
  std::vector<Complex> r = b;
  if (!symmetric_) {
    multiply(CblasNoTrans, CblasNoTrans, n_, x.size() / n_, n_, -1, matrix_.data(), n_, x.data(),
             n_, 1, r.data(), n_);
    return r;
  }
  const Complex one = 1, minus_one = -1;
  const auto n = blas_size(n_), columns = blas_size(x.size() / n_);
  cblas_zsymm(CblasColMajor, CblasLeft, CblasUpper, n, columns, &minus_one, matrix_.data(), n,
              x.data(), n, &one, r.data(), n);
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] += (matrix_[(i % n_) * (n_ + 1)] - diagonal_[i % n_]) * x[i];
  return r;
}

// Returns the largest backward error of all columns; infinite if a value is not finite.
double DenseFactor::backward_error(const std::vector<Complex>& b, const std::vector<Complex>& x,
                                   const std::vector<Complex>& r) const {
  double worst = 0;
  for (std::size_t start = 0; start < b.size(); start += n_) {
    const double scale =
        norm_ * std::sqrt(squared_norm(&x[start], n_)) + std::sqrt(squared_norm(&b[start], n_));
    const double left = std::sqrt(squared_norm(&r[start], n_));
    if (left == 0) continue;
    const double error = left / scale;
    worst = std::max(worst, std::isfinite(error) ? error : std::numeric_limits<double>::infinity());
  }
  return worst;
}

bool DenseFactor::is_good(const std::vector<Complex>& b, const std::vector<Complex>& x) {
  const auto b_sums = combinations(b, n_), x_sums = combinations(x, n_);
  combined_residual_ = residual(b_sums, x_sums);
  return backward_error(b_sums, x_sums, combined_residual_) <= good;
}

// Refines x until the backward error is at the level of rounding or no longer halves. Returns
// whether the backward error is below `good`.
bool DenseFactor::refine(const std::vector<Complex>& b, std::vector<Complex>& x) const {
  constexpr double rounding = 1e-16;
  double before = std::numeric_limits<double>::infinity();
  for (;;) {
    std::vector<Complex> correction = residual(b, x);
    const double error = backward_error(b, x, correction);
    if (error <= rounding) return true;
    if (!(error < before / 2)) return error <= good;
    before = error;
    solve_once(correction);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += correction[i];
  }
}

// Estimates the condition number from the last columns of x, which are M^-1 times the vectors of
// append_probes(), and removes them. Their mean squared norm is the squared Frobenius norm of M^-1.
void DenseFactor::take_condition(std::vector<Complex>& x) {
  const std::size_t kept = x.size() - probes * n_;
  condition_ = norm_ * std::sqrt(squared_norm(x.data() + kept, probes * n_) / probes);
  x.resize(kept);
}

// Solves with the current factorization (L L^T or LU). Returns an empty result if the solution is
// not accurate.
std::vector<Complex> DenseFactor::attempt(const std::vector<Complex>& b, bool condition) {
  std::vector<Complex> x = b;
  if (condition) append_probes(x, n_);
  solve_once(x);
  if (condition) take_condition(x);
  if (!is_good(b, x) && !(refine(b, x) && is_good(b, x))) x.clear();
  return x;
}

std::vector<Complex> DenseFactor::solve(const std::vector<Complex>& columns, bool condition) {
  if (columns.empty() || n_ == 0) return columns;
  std::vector<Complex> x;
  if (factored_) x = attempt(columns, condition);
  if (x.empty() && !pivoted_ && (factored_ = factor_pivoted())) x = attempt(columns, condition);
  if (x.empty())
    throw std::runtime_error(
        "the multiple-scattering equations have no accurate numerical solution");
  return x;
}

}  // namespace flatspeckle::wave
