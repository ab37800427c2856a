#include "wave_solver/dense/symmetric_factor.h"

#include <algorithm>
#include <cmath>

#include "core/run/interrupt.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

// Column by column.
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

// Halves down to small ones, so that the panels of a block are made by BLAS too.
bool factor_block(Complex* a, std::size_t n, std::size_t ld) {
  if (n <= small) return factor_small(a, n, ld);
  const std::size_t half = n / 2;
  if (!factor_block(a, half, ld)) return false;
  triangular_solve(CblasRight, CblasLower, CblasTrans, n - half, half, a, ld, a + half, ld);
  subtract_square(n - half, half, a + half, a + half * (ld + 1), ld);
  return factor_block(a + half * (ld + 1), n - half, ld);
}

// C -= W W^T in the lower triangle, in strips of columns: what lies below their squares by three
// real products in place of four.
void subtract_in_strips(std::size_t n, std::size_t depth, const Complex* w, Complex* c,
                        std::size_t ld) {
  for (std::size_t first = 0; first < n; first += strip) {
    const std::size_t size = std::min(strip, n - first), end = first + size;
    subtract_square(size, depth, w + first, c + first * (ld + 1), ld);
    if (end < n)
      subtract_product(n - end, size, depth, w + end, w + first, c + first * ld + end, ld);
  }
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

}  // namespace flatspeckle::wave
