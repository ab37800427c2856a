#include "wave_solver/dense/dense_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/symmetric_factor.h"

namespace flatspeckle::wave {

namespace {

constexpr double good = 1e-14;  // backward error

double squared_norm(const Complex* values, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i)
    sum += values[i].real() * values[i].real() + values[i].imag() * values[i].imag();
  return sum;
}

// The sum of all columns with scattered phases: what is wrong in any shows in it.
std::vector<Complex> combination(const std::vector<Complex>& columns, std::size_t n) {
  constexpr double golden_angle = 2.399963229728653;
  std::vector<Complex> sum(n);
  for (std::size_t start = 0; start < columns.size(); start += n) {
    const Complex phase = std::polar(1.0, golden_angle * static_cast<double>(start / n));
    cblas_zaxpy(static_cast<blasint>(n), &phase, &columns[start], 1, sum.data(), 1);
  }
  return sum;
}

void conjugate(std::vector<Complex>& values) {
  for (Complex& value : values) value = std::conj(value);
}

}  // namespace

DenseFactor::DenseFactor(std::vector<Complex> matrix, std::size_t unknowns)
    : n_(unknowns), matrix_(std::move(matrix)), diagonal_(unknowns) {
  blas_single_thread();
  for (std::size_t j = 0; j < n_; ++j) diagonal_[j] = matrix_[j * (n_ + 1)];
  norm_ = std::sqrt(squared_norm(matrix_.data(), matrix_.size()));
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
  const auto n = static_cast<blasint>(n_), columns = static_cast<blasint>(x.size() / n_);
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

bool DenseFactor::is_good(const std::vector<Complex>& b, const std::vector<Complex>& x) const {
  const auto b_sum = combination(b, n_), x_sum = combination(x, n_);
  return backward_error(b_sum, x_sum, residual(b_sum, x_sum)) <= good;
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

// Empty if it does not do.
std::vector<Complex> DenseFactor::attempt(const std::vector<Complex>& b) const {
  std::vector<Complex> x = b;
  solve_once(x);
  if (!is_good(b, x) && !refine(b, x)) x.clear();
  return x;
}

std::vector<Complex> DenseFactor::solve(const std::vector<Complex>& columns) {
  if (columns.empty() || n_ == 0) return columns;
  std::vector<Complex> x;
  if (factored_) x = attempt(columns);
  if (x.empty() && !pivoted_ && (factored_ = factor_pivoted())) x = attempt(columns);
  if (x.empty())
    throw std::runtime_error("the multiple-scattering equations have no solution in reach");
  return x;
}

double DenseFactor::one_norm() const {
  std::vector<double> sums(n_);
  for (std::size_t j = 0; j < n_; ++j) {
    sums[j] += std::abs(diagonal_[j]);
    for (std::size_t i = 0; i < j; ++i) {
      const double size = std::abs(matrix_[j * n_ + i]);
      sums[i] += size;
      sums[j] += size;
    }
  }
  return *std::max_element(sums.begin(), sums.end());
}

double DenseFactor::condition() const {
  if (n_ == 0) return 1;
  const auto n = static_cast<lapack_int>(n_);
  std::vector<Complex> v(n_), x(n_);
  double inverse_norm = 0;
  lapack_int kase = 0, state[3] = {};
  for (;;) {
    LAPACKE_zlacn2(n, v.data(), x.data(), &inverse_norm, &kase, state);
    if (kase == 0) return inverse_norm * one_norm();
    const bool adjoint = kase == 2;  // M being symmetric, (M^-1)^H = conj(M^-1)
    if (adjoint) conjugate(x);
    solve_once(x);
    if (adjoint) conjugate(x);
  }
}

}  // namespace flatspeckle::wave
