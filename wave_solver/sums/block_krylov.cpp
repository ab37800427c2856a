#include "wave_solver/sums/block_krylov.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

void check(lapack_int info) {
  if (info != 0)
    throw std::runtime_error("gmres: the matrix gave what is not finite, or LAPACK failed");
}

}  // namespace

std::vector<double> column_norms(std::span<const Complex> columns, std::size_t rows) {
  std::vector<double> norms;
  for (std::size_t at = 0; at < columns.size(); at += rows)
    norms.push_back(cblas_dznrm2(static_cast<int>(rows), &columns[at], 1));
  return norms;
}

ColumnMajor orthonormalize(ColumnMajor& w, double drop) {
  const std::size_t most = std::min(w.rows, w.columns);
  std::vector<lapack_int> pivots(w.columns, 0);
  std::vector<Complex> tau(most);
  const auto rows = static_cast<int>(w.rows);
  check(LAPACKE_zgeqp3(LAPACK_COL_MAJOR, rows, static_cast<int>(w.columns), w.data.data(), rows,
                       pivots.data(), tau.data()));
  std::size_t rank = 0;
  while (rank < most && std::abs(w(rank, rank)) > drop) ++rank;
  ColumnMajor s(rank, w.columns);
  for (std::size_t j = 0; j < w.columns; ++j)
    for (std::size_t i = 0; i < std::min(rank, j + 1); ++i)
      s(i, static_cast<std::size_t>(pivots[j]) - 1) = w(i, j);
  if (rank > 0)
    check(LAPACKE_zungqr(LAPACK_COL_MAJOR, rows, static_cast<int>(rank), static_cast<int>(rank),
                         w.data.data(), rows, tau.data()));
  w.columns = rank;
  w.data.resize(w.rows * rank);
  return s;
}

ColumnMajor product(const ColumnMajor& a, const ColumnMajor& b) {
  ColumnMajor c(a.rows, b.columns);
  if (c.data.empty() || a.columns == 0) return c;
  multiply(CblasNoTrans, CblasNoTrans, a.rows, b.columns, a.columns, 1, a.data.data(), a.rows,
           b.data.data(), b.rows, 0, c.data.data(), c.rows);
  return c;
}

void KrylovBasis::append(const ColumnMajor& block) {
  data_.insert(data_.end(), block.data.begin(), block.data.end());
}

std::span<const Complex> KrylovBasis::last(std::size_t count) const {
  return std::span(data_).last(count * rows_);
}

// In slices of rows of fixed size.
ColumnMajor KrylovBasis::project_out(ColumnMajor& w) const {
  constexpr std::size_t slice = 4096;
  const std::size_t slices = (rows_ + slice - 1) / slice;
  ColumnMajor c(size(), w.columns);
  if (w.columns == 0) return c;
  std::vector<ColumnMajor> parts(slices, c);
  parallel_for(slices, [&](std::size_t s) {
    const std::size_t first = s * slice;
    multiply(CblasConjTrans, CblasNoTrans, size(), w.columns, std::min(slice, rows_ - first), 1,
             &data_[first], rows_, &w.data[first], rows_, 0, parts[s].data.data(), size());
  });
  for (const ColumnMajor& part : parts)
    for (std::size_t i = 0; i < c.data.size(); ++i) c.data[i] += part.data[i];
  parallel_for(slices, [&](std::size_t s) {
    const std::size_t first = s * slice;
    multiply(CblasNoTrans, CblasNoTrans, std::min(slice, rows_ - first), w.columns, size(), -1,
             &data_[first], rows_, c.data.data(), size(), 1, &w.data[first], rows_);
  });
  return c;
}

ColumnMajor KrylovBasis::combine(const ColumnMajor& y) const {
  ColumnMajor x(rows_, y.columns);
  multiply(CblasNoTrans, CblasNoTrans, rows_, y.columns, y.rows, 1, data_.data(), rows_,
           y.data.data(), y.rows, 0, x.data.data(), rows_);
  return x;
}

void HessenbergLeastSquares::append(ColumnMajor h, std::size_t below) {
  for (const Reflection& step : steps_) reflect(step, h);
  const std::size_t top = columns_.size();
  Reflection step{top, ColumnMajor(h.columns + below, h.columns), std::vector<Complex>(h.columns)};
  for (std::size_t j = 0; j < h.columns; ++j)
    std::copy_n(h.column(j) + top, step.factor.rows, step.factor.column(j));
  const auto rows = static_cast<int>(step.factor.rows);
  check(LAPACKE_zgeqrf(LAPACK_COL_MAJOR, rows, static_cast<int>(h.columns), step.factor.data.data(),
                       rows, step.tau.data()));
  grow(below);
  reflect(step, g_);
  for (std::size_t j = 0; j < h.columns; ++j) {
    std::vector<Complex> column(h.column(j), h.column(j) + top + j + 1);
    std::copy_n(step.factor.column(j), j + 1, column.begin() + top);
    columns_.push_back(std::move(column));
  }
  steps_.push_back(std::move(step));
}

std::vector<double> HessenbergLeastSquares::residuals() {
  std::vector<double> norms;
  for (std::size_t j = 0; j < g_.columns; ++j)
    norms.push_back(cblas_dznrm2(static_cast<int>(g_.rows - columns_.size()),
                                 g_.column(j) + columns_.size(), 1));
  return norms;
}

ColumnMajor HessenbergLeastSquares::solution() {
  const std::size_t n = columns_.size();
  ColumnMajor r(n, n), y(n, g_.columns);
  for (std::size_t j = 0; j < n; ++j)
    std::copy(columns_[j].begin(), columns_[j].end(), r.column(j));
  for (std::size_t j = 0; j < y.columns; ++j) std::copy_n(g_.column(j), n, y.column(j));
  triangular_solve(CblasLeft, CblasUpper, CblasNoTrans, n, y.columns, r.data.data(), n,
                   y.data.data(), n);
  return y;
}

void HessenbergLeastSquares::reflect(const Reflection& step, ColumnMajor& target) {
  if (target.columns == 0) return;
  const auto rows = static_cast<int>(step.factor.rows);
  check(LAPACKE_zunmqr(LAPACK_COL_MAJOR, 'L', 'C', rows, static_cast<int>(target.columns),
                       static_cast<int>(step.factor.columns), step.factor.data.data(), rows,
                       step.tau.data(), target.data.data() + step.top,
                       static_cast<int>(target.rows)));
}

void HessenbergLeastSquares::grow(std::size_t rows) {
  ColumnMajor taller(g_.rows + rows, g_.columns);
  for (std::size_t j = 0; j < g_.columns; ++j) std::copy_n(g_.column(j), g_.rows, taller.column(j));
  g_ = std::move(taller);
}

}  // namespace flatspeckle::wave
