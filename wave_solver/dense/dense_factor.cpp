#include "wave_solver/dense/dense_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/numbers/random.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/columns.h"
#include "wave_solver/dense/symmetric_factor.h"

namespace flatspeckle::wave {

namespace {

constexpr double good = 1e-14;  // backward error
constexpr std::size_t probes = 4;

double squared_norm(const Complex* values, std::size_t n) {
  const auto* parts = reinterpret_cast<const double*>(values);
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (std::size_t i = 0; i < 2 * n; ++i) sum += parts[i] * parts[i];
  return sum;
}

// From the lower triangle.
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

DenseFactor::DenseFactor(Entries matrix, std::size_t unknowns)
    : n_(unknowns), matrix_(std::move(matrix)), diagonal_(unknowns) {
  blas_single_thread();
  for (std::size_t j = 0; j < n_; ++j) diagonal_[j] = matrix_[j * (n_ + 1)];
  norm_ = frobenius_norm(matrix_, n_);
  if (!std::isfinite(norm_))
    throw std::runtime_error("the multiple-scattering equations are not finite");
  factored_ = factor_symmetric(matrix_.data(), n_, n_);
}

bool DenseFactor::factor_pivoted() {
  const auto n = static_cast<lapack_int>(n_);
  lu_.resize(n_ * n_);
  for (std::size_t j = 0; j < n_; ++j) {
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

// From the upper triangle, with the diagonal put right.
std::vector<Complex> DenseFactor::residual(const std::vector<Complex>& b,
                                           const std::vector<Complex>& x) const {
  std::vector<Complex> r = b;
  const Complex one = 1, minus_one = -1;
  const auto n = blas_size(n_), columns = blas_size(x.size() / n_);
  cblas_zsymm(CblasColMajor, CblasLeft, CblasUpper, n, columns, &minus_one, matrix_.data(), n,
              x.data(), n, &one, r.data(), n);
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] += (matrix_[(i % n_) * (n_ + 1)] - diagonal_[i % n_]) * x[i];
  return r;
}

// The largest of all columns; infinite if anything is not finite.
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
  remainder_ = residual(b_sums, x_sums);
  return backward_error(b_sums, x_sums, remainder_) <= good;
}

// Until the backward error is that of rounding or falls no further. False if it is not good.
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

// What M^-1 makes of vectors of random phases, the last columns, is on average its norm.
void DenseFactor::take_condition(std::vector<Complex>& x) {
  const std::size_t kept = x.size() - probes * n_;
  condition_ = norm_ * std::sqrt(squared_norm(x.data() + kept, probes * n_) / probes);
  x.resize(kept);
}

// Empty if it does not do.
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
    throw std::runtime_error("the multiple-scattering equations have no solution in reach");
  return x;
}

}  // namespace flatspeckle::wave
