#include "core/algebra/dense.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/numbers/blas.h"
#include "core/numbers/complex.h"

namespace flatspeckle {

namespace {

constexpr const char* singular = "singular matrix";

void multiply(const double* a, Eigen::Index rows, const Matrix& b, double* c) {
  const auto m = static_cast<blasint>(rows), n = static_cast<blasint>(b.cols()),
             inner = static_cast<blasint>(b.rows());
  const auto height = std::max<blasint>(m, 1);  // BLAS requires at least 1, even for empty matrices
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, m, n, inner, 1, a, height, b.data(), inner,
              0, c, height);
}

Rows multiply(const Rows& a, const Rows& b, CBLAS_TRANSPOSE turned) {
  const bool as_it_is = turned == CblasNoTrans;
  Rows c(a.rows(), as_it_is ? b.cols() : b.rows());
  const auto m = static_cast<blasint>(a.rows()), n = static_cast<blasint>(c.cols()),
             inner = static_cast<blasint>(a.cols());
  const std::complex<double> one = 1, zero = 0;
  const auto height = std::max<blasint>(m, 1);
  cblas_zgemm(CblasColMajor, CblasNoTrans, turned, m, n, inner, &one, a.data(), height, b.data(),
              std::max<blasint>(static_cast<blasint>(b.rows()), 1), &zero, c.data(), height);
  return c;
}

}  // namespace

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c(a.rows(), b.cols());
  multiply(a.data(), a.rows(), b, c.data());
  return c;
}

Rows product(const Rows& rows, const Matrix& a) {
  Rows c(rows.rows(), a.cols());
  multiply(reinterpret_cast<const double*>(rows.data()), 2 * rows.rows(), a,
           reinterpret_cast<double*>(c.data()));
  return c;
}

Rows product(const Rows& a, const Rows& b) {
  return multiply(a, b, CblasNoTrans);
}

Rows product_transposed(const Rows& a, const Rows& b) {
  return multiply(a, b, CblasTrans);
}

Rows scaled(std::span<const std::complex<double>> factor, Rows rows) {
  for (Eigen::Index j = 0; j < rows.cols(); ++j)
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      rows(i, j) = product(factor[static_cast<std::size_t>(i)], rows(i, j));
  return rows;
}

namespace {

constexpr auto columns_first = LAPACK_COL_MAJOR;

int factor(Matrix& a, int* pivots) {
  const auto n = static_cast<lapack_int>(a.rows());
  return LAPACKE_dgetrf(columns_first, n, n, a.data(), n, pivots);
}
int factor(Rows& a, int* pivots) {
  const auto n = static_cast<lapack_int>(a.rows());
  return LAPACKE_zgetrf(columns_first, n, n, a.data(), n, pivots);
}

void solve(const Matrix& factors, const int* pivots, Matrix& b) {
  const auto n = static_cast<lapack_int>(factors.rows());
  LAPACKE_dgetrs_work(columns_first, 'N', n, static_cast<lapack_int>(b.cols()), factors.data(), n,
                      pivots, b.data(), n);
}
void solve(const Rows& factors, const int* pivots, Rows& b) {
  const auto n = static_cast<lapack_int>(factors.rows());
  LAPACKE_zgetrs_work(columns_first, 'N', n, static_cast<lapack_int>(b.cols()), factors.data(), n,
                      pivots, b.data(), n);
}

/// Replaces the matrix `rows` by rows U^-1 L^-1, where L and U are the triangular LU factors in
/// `factors`.
void solve_triangles(Rows& rows, const Matrix& factors) {
  const auto m = static_cast<blasint>(2 * rows.rows()), n = static_cast<blasint>(factors.rows());
  auto* const data = reinterpret_cast<double*>(rows.data());
  for (const auto& [part, diagonal] :
       {std::pair(CblasUpper, CblasNonUnit), {CblasLower, CblasUnit}})
    cblas_dtrsm(CblasColMajor, CblasRight, part, CblasNoTrans, diagonal, m, n, 1, factors.data(), n,
                data, std::max<blasint>(m, 1));
}
void solve_triangles(Rows& rows, const Rows& factors) {
  const std::complex<double> one = 1;
  const auto m = static_cast<blasint>(rows.rows()), n = static_cast<blasint>(factors.rows());
  for (const auto& [part, diagonal] :
       {std::pair(CblasUpper, CblasNonUnit), {CblasLower, CblasUnit}})
    cblas_ztrsm(CblasColMajor, CblasRight, part, CblasNoTrans, diagonal, m, n, &one, factors.data(),
                n, rows.data(), std::max<blasint>(m, 1));
}

}  // namespace

template <typename M>
FactorsOf<M>::FactorsOf(M a)
    : factors_(std::move(a)), pivots_(static_cast<std::size_t>(factors_.rows())) {
  if (factor(factors_, pivots_.data()) != 0) throw std::runtime_error(singular);
}

template <typename M>
M FactorsOf<M>::before(M b) const {
  solve(factors_, pivots_.data(), b);
  return b;
}

template <typename M>
Rows FactorsOf<M>::after(Rows rows) const {
  solve_triangles(rows, factors_);
  for (auto j = static_cast<Eigen::Index>(pivots_.size()); j-- > 0;)
    if (const auto with = pivots_[static_cast<std::size_t>(j)] - 1; with != j)
      rows.col(j).swap(rows.col(with));
  return rows;
}

template class FactorsOf<Matrix>;
template class FactorsOf<Rows>;

}  // namespace flatspeckle
