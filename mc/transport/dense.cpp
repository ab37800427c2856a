#include "mc/transport/dense.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "core/numbers/blas.h"
#include "core/numbers/complex.h"

namespace flatspeckle::mc {

namespace {

constexpr const char* singular = "transport through a slab: singular matrix";

void multiply(const double* a, Eigen::Index rows, const Matrix& b, double* c) {
  const auto m = static_cast<blasint>(rows), n = static_cast<blasint>(b.cols()),
             inner = static_cast<blasint>(b.rows());
  const auto height = std::max<blasint>(m, 1);  // BLAS wants it even of nothing
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
      rows(i, j) = flatspeckle::product(factor[static_cast<std::size_t>(i)], rows(i, j));
  return rows;
}

Matrix inverse(Matrix a) {
  const auto n = static_cast<lapack_int>(a.rows());
  std::vector<lapack_int> pivots(static_cast<std::size_t>(n));
  if (LAPACKE_dgetrf(LAPACK_COL_MAJOR, n, n, a.data(), n, pivots.data()) != 0 ||
      LAPACKE_dgetri(LAPACK_COL_MAJOR, n, a.data(), n, pivots.data()) != 0)
    throw std::runtime_error(singular);
  return a;
}

Rows inverse(Rows a) {
  const auto n = static_cast<lapack_int>(a.rows());
  std::vector<lapack_int> pivots(static_cast<std::size_t>(n));
  if (LAPACKE_zgetrf(LAPACK_COL_MAJOR, n, n, a.data(), n, pivots.data()) != 0 ||
      LAPACKE_zgetri(LAPACK_COL_MAJOR, n, a.data(), n, pivots.data()) != 0)
    throw std::runtime_error(singular);
  return a;
}

}  // namespace flatspeckle::mc
