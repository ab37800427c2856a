#include "wave_solver/dense_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "wave_solver/blas.h"
#include "wave_solver/symmetric_factor.h"

namespace flatspeckle::wave {

namespace {

constexpr double good = 1e-14;  // backward error

// Measured on zsyrk, csyrk and zsymm: three solutions in single precision and two residuals pay
// from here on.
bool mixed_pays(std::size_t unknowns, std::size_t columns) {
  return unknowns > 30 * columns + 300;
}

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

bool fits_single(Complex value) {
  constexpr double most = std::numeric_limits<float>::max();
  return std::abs(value.real()) < most && std::abs(value.imag()) < most;
}

}  // namespace

DenseFactor::DenseFactor(std::vector<Complex> matrix, std::size_t unknowns)
    : n_(unknowns), matrix_(std::move(matrix)), diagonal_(unknowns) {
  blas_single_thread();
  double squares = 0;
  for (std::size_t j = 0; j < n_; ++j) {
    diagonal_[j] = matrix_[j * (n_ + 1)];
    double sum = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      const double square = std::norm(matrix_[j * n_ + i]);
      squares += square;
      sum += std::sqrt(square);
    }
    one_norm_ = std::max(one_norm_, sum);
  }
  norm_ = std::sqrt(squares);
  if (!std::isfinite(norm_))
    throw std::runtime_error("the multiple-scattering equations are not finite");
}

bool DenseFactor::factor() {
  const auto n = static_cast<lapack_int>(n_);
  factored_ = true;
  switch (method_) {
    case Method::mixed:
      if (!std::all_of(matrix_.begin(), matrix_.end(), fits_single)) return false;
      single_.assign(matrix_.begin(), matrix_.end());
      return factor_symmetric(single_.data(), n_, n_);
    case Method::symmetric:
      single_ = {};
      return factor_symmetric(matrix_.data(), n_, n_);
    default:
      lu_.resize(n_ * n_);
      for (std::size_t j = 0; j < n_; ++j) {
        lu_[j * (n_ + 1)] = diagonal_[j];
        for (std::size_t i = 0; i < j; ++i) lu_[j * n_ + i] = lu_[i * n_ + j] = matrix_[j * n_ + i];
      }
      pivots_.resize(n_);
      return LAPACKE_zgetrf(LAPACK_COL_MAJOR, n, n, lu_.data(), n, pivots_.data()) == 0;
  }
}

void DenseFactor::solve_once(std::vector<Complex>& x) const {
  const std::size_t columns = x.size() / n_;
  const auto n = static_cast<lapack_int>(n_);
  if (method_ == Method::symmetric) {
    solve_forward(matrix_.data(), n_, n_, x.data(), columns, n_);
    solve_backward(matrix_.data(), n_, n_, x.data(), columns, n_);
  } else if (method_ == Method::mixed) {
    std::vector<std::complex<float>> y(x.begin(), x.end());
    solve_forward(single_.data(), n_, n_, y.data(), columns, n_);
    solve_backward(single_.data(), n_, n_, y.data(), columns, n_);
    std::copy(y.begin(), y.end(), x.begin());
  } else {
    LAPACKE_zgetrs(LAPACK_COL_MAJOR, 'N', n, static_cast<lapack_int>(columns), lu_.data(), n,
                   pivots_.data(), x.data(), n);
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

std::vector<Complex> DenseFactor::right_method(const std::vector<Complex>& b) {
  for (;;) {
    const bool ready = factored_ || factor();
    if (ready) {
      std::vector<Complex> x = b;
      solve_once(x);
      if ((method_ != Method::mixed && is_good(b, x)) || refine(b, x)) return x;
    }
    if (method_ == Method::pivoted)
      throw std::runtime_error("the multiple-scattering equations have no solution in reach");
    method_ = method_ == Method::mixed ? Method::symmetric : Method::pivoted;
    factored_ = false;
  }
}

std::vector<Complex> DenseFactor::solve(const std::vector<Complex>& columns) {
  if (columns.empty() || n_ == 0) return columns;
  if (!factored_ && mixed_pays(n_, columns.size() / n_)) method_ = Method::mixed;
  return right_method(columns);
}

double DenseFactor::condition() const {
  if (n_ == 0) return 1;
  const auto n = static_cast<lapack_int>(n_);
  std::vector<Complex> v(n_), x(n_);
  double inverse_norm = 0;
  lapack_int kase = 0, state[3] = {};
  for (;;) {
    LAPACKE_zlacn2(n, v.data(), x.data(), &inverse_norm, &kase, state);
    if (kase == 0) return inverse_norm * one_norm_;
    const bool adjoint = kase == 2;  // (M^-1)^H = conj(M^-1), M being symmetric
    if (adjoint) std::transform(x.begin(), x.end(), x.begin(), [](Complex c) { return std::conj(c); });
    solve_once(x);
    if (adjoint) std::transform(x.begin(), x.end(), x.begin(), [](Complex c) { return std::conj(c); });
  }
}

std::string describe(DenseFactor::Method method) {
  if (method == DenseFactor::Method::mixed) return "single-precision L L^T, refined";
  return method == DenseFactor::Method::symmetric ? "symmetric L L^T" : "LU with pivoting";
}

}  // namespace flatspeckle::wave
