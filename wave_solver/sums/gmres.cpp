#include "wave_solver/sums/gmres.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contract.h"
#include "core/run/interrupt.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/sums/block_krylov.h"

namespace flatspeckle::wave {

namespace {

// Norms of right sides; 1 for a vanishing one.
std::vector<double> units(std::span<const Complex> b, std::size_t unknowns) {
  auto norms = column_norms(b, unknowns);
  std::replace(norms.begin(), norms.end(), 0.0, 1.0);
  return norms;
}

std::vector<Complex> remainder(const BlockMap& a, std::span<const Complex> x,
                               std::span<const Complex> b) {
  auto left = a(x);
  for (std::size_t i = 0; i < b.size(); ++i) left[i] = b[i] - left[i];
  return left;
}

std::vector<double> relative(std::span<const Complex> remainder, std::span<const double> units) {
  auto norms = column_norms(remainder, remainder.size() / units.size());
  for (std::size_t j = 0; j < norms.size(); ++j) norms[j] /= units[j];
  return norms;
}

// One block of right sides.
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

  // Searches one Krylov space, in units in which every right side has norm 1.
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

  // Appends A times the last `width` vectors; returns how many new directions that gave.
  std::size_t extend(KrylovBasis& basis, HessenbergLeastSquares& problem, std::size_t width,
                     double drop) const {
    ColumnMajor w(x_.rows, width);
    w.data = a_(preconditioned(basis.last(width)));
    const double scale = cblas_dznrm2(static_cast<int>(w.data.size()), w.data.data(), 1);
    ColumnMajor inside = basis.project_out(w);
    ColumnMajor s = orthonormalize(w, drop * scale);
    // Again, since what is left may be small and mostly rounding within the span.
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

  void update_residual() { residual_.data = remainder(a_, x_.data, b_); }

  const BlockMap& a_;
  std::span<const Complex> b_;
  ColumnMajor x_, residual_;
  const GmresOptions& options_;
  std::vector<double> norms_;
  int steps_ = 0;
};

}  // namespace

GmresResult gmres(const BlockMap& a, std::size_t unknowns, std::span<const Complex> right_sides,
                  const GmresOptions& options) {
  GmresResult result;
  if (unknowns == 0) return result;
  FS_EXPECT(right_sides.size() % unknowns == 0);
  blas_single_thread();
  const std::size_t most = unknowns * static_cast<std::size_t>(options.block);
  for (std::size_t at = 0; at < right_sides.size(); at += most) {
    const auto b = right_sides.subspan(at, std::min(most, right_sides.size() - at));
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

}  // namespace flatspeckle::wave
