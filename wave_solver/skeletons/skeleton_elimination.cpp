#include "wave_solver/skeletons/skeleton_elimination.h"

#include <stdexcept>

#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/symmetric_factor.h"
#include "wave_solver/equations/tiles.h"

namespace flatspeckle::wave {

namespace {

std::vector<Complex> submatrix(const std::vector<Complex>& m, std::size_t n,
                               const std::vector<std::size_t>& rows,
                               const std::vector<std::size_t>& columns) {
  std::vector<Complex> part;
  part.reserve(rows.size() * columns.size());
  for (std::size_t j : columns)
    for (std::size_t i : rows) part.push_back(m[i + n * j]);
  return part;
}

std::vector<std::size_t> chosen(const std::vector<std::size_t>& from,
                                const std::vector<std::size_t>& places) {
  std::vector<std::size_t> values;
  values.reserve(places.size());
  for (std::size_t place : places) values.push_back(from[place]);
  return values;
}

// Rows of X of some unknowns, and back.
std::vector<Complex> gather(const Complex* x, const std::vector<std::size_t>& unknowns,
                            std::size_t columns) {
  std::vector<Complex> part(unknowns.size() * columns);
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    std::copy_n(x + unknowns[i] * columns, columns, &part[i * columns]);
  return part;
}

void scatter(const std::vector<Complex>& part, const std::vector<std::size_t>& unknowns,
             std::size_t columns, Complex* x) {
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    std::copy_n(&part[i * columns], columns, x + unknowns[i] * columns);
}

// C <- old C + factor A B, or A B^T, of a complex A and a real B, by the real view of A.
void add_product(CBLAS_TRANSPOSE transpose, std::size_t rows, std::size_t columns,
                 std::size_t inner, double factor, const std::vector<Complex>& a,
                 const std::vector<double>& b, double old, std::vector<Complex>& c) {
  cblas_dgemm(CblasColMajor, CblasNoTrans, transpose, blas_size(2 * rows), blas_size(columns),
              blas_size(inner), factor, reinterpret_cast<const double*>(a.data()),
              blas_size(2 * rows), b.data(), blas_size(transpose == CblasTrans ? columns : inner),
              old, reinterpret_cast<double*>(c.data()), blas_size(2 * rows));
}

// C <- C - A B, or A B^T
void subtract_product(CBLAS_TRANSPOSE transpose, std::size_t rows, std::size_t columns,
                      std::size_t inner, const std::vector<Complex>& a,
                      const std::vector<Complex>& b, std::size_t ldb, std::vector<Complex>& c) {
  multiply(CblasNoTrans, transpose, rows, columns, inner, -1, a.data(), rows, b.data(), ldb, 1,
           c.data(), rows);
}

// X <- X L^-T (transposed) or X L^-1
void divide(CBLAS_TRANSPOSE transpose, std::size_t rows, std::size_t n,
            const std::vector<Complex>& l, std::vector<Complex>& x) {
  triangular_solve(CblasRight, CblasLower, transpose, rows, n, l.data(), n, x.data(), rows);
}

}  // namespace

SkeletonElimination::SkeletonElimination(const std::vector<std::size_t>& unknowns,
                                         const std::vector<Complex>& m,
                                         const Interpolation& interpolation)
    : skeleton_(chosen(unknowns, interpolation.skeleton)),
      redundant_(chosen(unknowns, interpolation.redundant)),
      t_(interpolation.t),
      e_(submatrix(m, unknowns.size(), interpolation.skeleton, interpolation.redundant)),
      l_(submatrix(m, unknowns.size(), interpolation.redundant, interpolation.redundant)),
      rest_(submatrix(m, unknowns.size(), interpolation.skeleton, interpolation.skeleton)) {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  if (r == 0) return;
  if (s > 0) congruence();
  if (!factor_symmetric(l_.data(), r, r))
    throw std::runtime_error("the multiple-scattering equations of a box are singular");
  if (s == 0) return;
  divide(CblasTrans, s, r, l_, e_);
  subtract_square(s, r, e_.data(), rest_.data(), s);
  mirror_lower(rest_, s);
}

// From M_SS, M_SR, M_RR in rest_, e_, l_ to Q in e_ and X_RR in the lower triangle of l_:
// X_RR = M_RR - P T - (P T)^T with P^T = M_SR - M_SS T / 2.
void SkeletonElimination::congruence() {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  std::vector<Complex> half(s * r), p(r * s), p_t(r * r);
  add_product(CblasTrans, s, r, s, 0.5, rest_, t_, 0, half);
  for_each_tiled(
      r, s, [&](std::size_t i, std::size_t j) { p[i + r * j] = e_[j + s * i] - half[j + s * i]; });
  for (std::size_t i = 0; i < e_.size(); ++i) e_[i] -= 2.0 * half[i];
  add_product(CblasTrans, r, r, s, 1, p, t_, 0, p_t);
  for_each_tiled(r, r, [&](std::size_t i, std::size_t j) {
    if (i >= j) l_[i + r * j] -= p_t[i + r * j] + p_t[j + r * i];
  });
}

double SkeletonElimination::bytes() const {
  return static_cast<double>(sizeof(double) * t_.size() +
                             sizeof(Complex) * (e_.size() + l_.size()) +
                             sizeof(std::size_t) * (skeleton_.size() + redundant_.size()));
}

// b_R <- L^-1 (b_R - T^T b_S), b_S <- b_S - E b_R, each column of X a row here
void SkeletonElimination::forward(Complex* x, std::size_t columns) const {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  if (r == 0) return;
  auto x_s = gather(x, skeleton_, columns), x_r = gather(x, redundant_, columns);
  if (s > 0) add_product(CblasTrans, columns, r, s, -1, x_s, t_, 1, x_r);
  divide(CblasTrans, columns, r, l_, x_r);
  if (s > 0) subtract_product(CblasTrans, columns, s, r, x_r, e_, s, x_s);
  scatter(x_s, skeleton_, columns, x);
  scatter(x_r, redundant_, columns, x);
}

// x_R <- L^-T (x_R - E^T x_S), x_S <- x_S - T x_R
void SkeletonElimination::backward(Complex* x, std::size_t columns) const {
  const std::size_t s = skeleton_.size(), r = redundant_.size();
  if (r == 0) return;
  auto x_s = gather(x, skeleton_, columns), x_r = gather(x, redundant_, columns);
  if (s > 0) subtract_product(CblasNoTrans, columns, r, s, x_s, e_, s, x_r);
  divide(CblasNoTrans, columns, r, l_, x_r);
  if (s > 0) add_product(CblasNoTrans, columns, s, r, -1, x_r, t_, 1, x_s);
  scatter(x_s, skeleton_, columns, x);
  scatter(x_r, redundant_, columns, x);
}

}  // namespace flatspeckle::wave
