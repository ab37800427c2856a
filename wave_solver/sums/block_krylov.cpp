#include "wave_solver/sums/block_krylov.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/contract.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

// Returns the norm of each right-hand side, or 1 if that norm is 0.
std::vector<double> units(std::span<const Complex> b, std::size_t unknowns) {
  auto norms = column_norms(b, unknowns);
  std::replace(norms.begin(), norms.end(), 0.0, 1.0);
  return norms;
}

std::vector<Complex> residual_of(const BlockMap& a, std::span<const Complex> x,
                                 std::span<const Complex> b) {
  auto left = a(x);
  for (std::size_t i = 0; i < b.size(); ++i) left[i] = b[i] - left[i];
  return left;
}

std::vector<double> relative(std::span<const Complex> residual, std::span<const double> units) {
  auto norms = column_norms(residual, residual.size() / units.size());
  for (std::size_t j = 0; j < norms.size(); ++j) norms[j] /= units[j];
  return norms;
}

// GMRES for one block of right-hand sides.
class Block {
 public:
  Block(const BlockMap& a, std::size_t unknowns, std::span<const Complex> b,
        const GmresOptions& options)
      : a_(a),
        b_(b),
        x_(unknowns, b.size() / unknowns),
        residual_(x_),
        options_(options),
        norms_(units(b, unknowns)) {
    residual_.data.assign(b.begin(), b.end());
  }

  void solve() {
    double before = std::numeric_limits<double>::infinity(), now = worst();
    while (now > options_.tolerance && now < before / 2 && steps_ < options_.products) {
      cycle();
      update_residual();
      before = now;
      now = worst();
    }
  }

  std::vector<double> residuals() const { return relative(residual_.data, norms_); }
  const ColumnMajor& x() const { return x_; }
  int steps() const { return steps_; }

 private:
  double worst() const {
    const auto all = residuals();
    return *std::max_element(all.begin(), all.end());
  }

  std::vector<Complex> preconditioned(std::span<const Complex> v) const {
    return options_.preconditioner ? options_.preconditioner(v)
                                   : std::vector<Complex>(v.begin(), v.end());
  }

  // Minimises the residual over one Krylov space. The right-hand sides are scaled to norm 1.
  void cycle() {
    ColumnMajor start = residual_;
    for (std::size_t j = 0; j < start.columns; ++j)
      cblas_zdscal(static_cast<int>(start.rows), 1 / norms_[j], start.column(j), 1);
    const double drop = 0.01 * options_.tolerance;
    ColumnMajor g = orthonormalize(start, drop);
    KrylovBasis basis(start.rows);
    basis.append(start);
    HessenbergLeastSquares problem(std::move(g));
    std::size_t width = start.columns;
    while (width > 0 && steps_ < options_.products) {
      stop_if_interrupted();
      width = extend(basis, problem, width, drop);
      ++steps_;
      const auto left = problem.residuals();
      if (*std::max_element(left.begin(), left.end()) < 0.5 * options_.tolerance) break;
      if (16.0 * static_cast<double>((basis.size() + width) * start.rows) > options_.basis_bytes)
        break;
    }
    const ColumnMajor y = problem.solution();
    if (std::isfinite(cblas_dznrm2(static_cast<int>(y.data.size()), y.data.data(), 1)))
      add_correction(basis.combine(y));
  }

  // Extends the Krylov basis by A times its last `width` vectors. Returns the number of new basis
  // vectors.
  std::size_t extend(KrylovBasis& basis, HessenbergLeastSquares& problem, std::size_t width,
                     double drop) const {
    ColumnMajor w(x_.rows, width);
    w.data = a_(preconditioned(basis.last(width)));
    const double scale = cblas_dznrm2(static_cast<int>(w.data.size()), w.data.data(), 1);
    ColumnMajor inside = basis.project_out(w);
    ColumnMajor s = orthonormalize(w, drop * scale);
    // The projection is repeated, because w may now be small and consist mostly of rounding errors
    // in the span of the basis.
    const ColumnMajor inside_again = product(basis.project_out(w), s);
    for (std::size_t i = 0; i < inside.data.size(); ++i) inside.data[i] += inside_again.data[i];
    s = product(orthonormalize(w, 0), s);
    ColumnMajor h(inside.rows + s.rows, width);
    for (std::size_t j = 0; j < width; ++j) {
      std::copy_n(inside.column(j), inside.rows, h.column(j));
      std::copy_n(s.column(j), s.rows, h.column(j) + inside.rows);
    }
    problem.append(std::move(h), s.rows);
    basis.append(w);
    return w.columns;
  }

  void add_correction(const ColumnMajor& z) {
    const auto correction = preconditioned(z.data);
    for (std::size_t j = 0; j < x_.columns; ++j)
      for (std::size_t i = 0; i < x_.rows; ++i) x_(i, j) += norms_[j] * correction[j * x_.rows + i];
  }

  void update_residual() { residual_.data = residual_of(a_, x_.data, b_); }

  const BlockMap& a_;
  std::span<const Complex> b_;
  ColumnMajor x_, residual_;
  const GmresOptions& options_;
  std::vector<double> norms_;
  int steps_ = 0;
};

void check(lapack_int info) {
  if (info != 0)
    throw std::runtime_error("gmres: a product with the matrix is not finite, or LAPACK failed");
}

}  // namespace

GmresResult gmres(const BlockMap& a, std::size_t unknowns,
                  std::span<const Complex> right_hand_sides, const GmresOptions& options) {
  GmresResult result;
  if (unknowns == 0) return result;
  FS_EXPECT(right_hand_sides.size() % unknowns == 0);
  blas_single_thread();
  const std::size_t most = unknowns * static_cast<std::size_t>(options.block);
  for (std::size_t at = 0; at < right_hand_sides.size(); at += most) {
    const auto b = right_hand_sides.subspan(at, std::min(most, right_hand_sides.size() - at));
    Block block(a, unknowns, b, options);
    block.solve();
    const auto residuals = block.residuals();
    result.x.insert(result.x.end(), block.x().data.begin(), block.x().data.end());
    result.residuals.insert(result.residuals.end(), residuals.begin(), residuals.end());
    result.steps.insert(result.steps.end(), residuals.size(), block.steps());
    for (const double r : residuals) result.converged = result.converged && r <= options.tolerance;
  }
  return result;
}

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

// Slices of rows have a fixed size, so that the result does not depend on the number of threads.
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
