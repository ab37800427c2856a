#include "wave_solver/symmetric_factor.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "wave_solver/blas.h"

namespace flatspeckle::wave {

namespace {

template <typename Real>
void triangular_solve(CBLAS_SIDE side, CBLAS_TRANSPOSE transpose, std::size_t rows,
                      std::size_t columns, const std::complex<Real>* l, std::size_t ld,
                      std::complex<Real>* x, std::size_t ldx) {
  const std::complex<Real> one = 1;
  const auto call = [&](auto trsm) {
    trsm(CblasColMajor, side, CblasLower, transpose, CblasNonUnit, static_cast<blasint>(rows),
         static_cast<blasint>(columns), &one, l, static_cast<blasint>(ld), x,
         static_cast<blasint>(ldx));
  };
  if constexpr (std::is_same_v<Real, double>)
    call(cblas_ztrsm);
  else
    call(cblas_ctrsm);
}

// C -= W W^T, lower triangle
template <typename Real>
void subtract_square(std::size_t n, std::size_t depth, const std::complex<Real>* w,
                     std::complex<Real>* c, std::size_t ld) {
  const std::complex<Real> one = 1, minus_one = -1;
  const auto call = [&](auto syrk) {
    syrk(CblasColMajor, CblasLower, CblasNoTrans, static_cast<blasint>(n),
         static_cast<blasint>(depth), &minus_one, w, static_cast<blasint>(ld), &one, c,
         static_cast<blasint>(ld));
  };
  if constexpr (std::is_same_v<Real, double>)
    call(cblas_zsyrk);
  else
    call(cblas_csyrk);
}

// y -= f x, spelt out: std::complex's product checks for NaN
template <typename Real>
void subtract_multiple(std::complex<Real> f, const std::complex<Real>* x, std::complex<Real>* y,
                       std::size_t n) {
  const Real re = f.real(), im = f.imag();
  const Real* from = reinterpret_cast<const Real*>(x);
  Real* to = reinterpret_cast<Real*>(y);
  for (std::size_t i = 0; i < n; ++i) {
    to[2 * i] -= re * from[2 * i] - im * from[2 * i + 1];
    to[2 * i + 1] -= re * from[2 * i + 1] + im * from[2 * i];
  }
}

// Column by column.
template <typename Real>
bool factor_small(std::complex<Real>* a, std::size_t n, std::size_t ld) {
  for (std::size_t j = 0; j < n; ++j) {
    std::complex<Real>* column = a + j * ld;
    const std::complex<Real> pivot = std::sqrt(column[j]);
    if (!(std::norm(pivot) > 0) || !std::isfinite(std::norm(pivot))) return false;
    column[j] = pivot;
    const std::complex<Real> inverse = Real(1) / pivot;
    for (std::size_t i = j + 1; i < n; ++i) column[i] *= inverse;
    for (std::size_t l = j + 1; l < n; ++l)
      subtract_multiple(column[l], column + l, a + l * ld + l, n - l);
  }
  return true;
}

constexpr std::size_t small = 32, block = 192;

// Halves down to small ones, so that the panels of a block are made by BLAS too.
template <typename Real>
bool factor_block(std::complex<Real>* a, std::size_t n, std::size_t ld) {
  if (n <= small) return factor_small(a, n, ld);
  const std::size_t half = n / 2;
  if (!factor_block(a, half, ld)) return false;
  triangular_solve(CblasRight, CblasTrans, n - half, half, a, ld, a + half, ld);
  subtract_square(n - half, half, a + half, a + half * (ld + 1), ld);
  return factor_block(a + half * (ld + 1), n - half, ld);
}

}  // namespace

template <typename Real>
bool factor_symmetric(std::complex<Real>* a, std::size_t n, std::size_t ld) {
  for (std::size_t first = 0; first < n; first += block) {
    const std::size_t size = std::min(block, n - first), rest = n - first - size;
    std::complex<Real>* corner = a + first * (ld + 1);
    if (!factor_block(corner, size, ld)) return false;
    if (rest == 0) break;
    triangular_solve(CblasRight, CblasTrans, rest, size, corner, ld, corner + size, ld);
    subtract_square(rest, size, corner + size, corner + size * (ld + 1), ld);
  }
  return true;
}

template <typename Real>
void solve_forward(const std::complex<Real>* l, std::size_t n, std::size_t ld,
                   std::complex<Real>* x, std::size_t columns, std::size_t ldx) {
  if (n > 0 && columns > 0)
    triangular_solve(CblasLeft, CblasNoTrans, n, columns, l, ld, x, ldx);
}

template <typename Real>
void solve_backward(const std::complex<Real>* l, std::size_t n, std::size_t ld,
                    std::complex<Real>* x, std::size_t columns, std::size_t ldx) {
  if (n > 0 && columns > 0) triangular_solve(CblasLeft, CblasTrans, n, columns, l, ld, x, ldx);
}

template bool factor_symmetric(std::complex<double>*, std::size_t, std::size_t);
template bool factor_symmetric(std::complex<float>*, std::size_t, std::size_t);
template void solve_forward(const std::complex<double>*, std::size_t, std::size_t,
                            std::complex<double>*, std::size_t, std::size_t);
template void solve_forward(const std::complex<float>*, std::size_t, std::size_t,
                            std::complex<float>*, std::size_t, std::size_t);
template void solve_backward(const std::complex<double>*, std::size_t, std::size_t,
                             std::complex<double>*, std::size_t, std::size_t);
template void solve_backward(const std::complex<float>*, std::size_t, std::size_t,
                             std::complex<float>*, std::size_t, std::size_t);

}  // namespace flatspeckle::wave
