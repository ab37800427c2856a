#include "wave_solver/solutions/equation_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/skeletons/fast_direct.h"
#include "wave_solver/sums/block_krylov.h"
#include "wave_solver/sums/fast_product.h"

namespace flatspeckle::wave {

namespace {

constexpr double best_product = 1e-12;  // the least tolerance of FastProduct
constexpr double rough_factor = 1e-6;   // finer ones cost more than the refinement that they save

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

}  // namespace

Method method_for(std::size_t unknowns, double tolerance) {
  const std::size_t dense_limit = tolerance < 1e-9 ? 5000 : 1500;
  return unknowns <= dense_limit ? Method::dense : Method::fast;
}

EquationSolver::EquationSolver(const WaveEquations& system, Method method, double tolerance)
    : system_(system), tolerance_(std::max(tolerance, best_product)) {
  if (method == Method::automatic) method = method_for(system.unknowns(), tolerance);
  if (method == Method::dense) {
    dense_ = std::make_unique<DenseFactor>(system.matrix(), system.unknowns());
    return;
  }
  product_ = std::make_unique<FastProduct>(system, std::max(tolerance_ / 10, best_product));
  if (method == Method::fast)
    fast_ = std::make_unique<FastDirect>(system, std::max(tolerance_ / 10, rough_factor));
}

EquationSolver::~EquationSolver() = default;

std::vector<Complex> EquationSolver::solve(const std::vector<Complex>& sides, bool condition) {
  if (fast_)
    if (auto x = refined(sides)) return std::move(*x);
  if (!dense_) return by_gmres(sides);
  auto x = dense_->solve(sides, condition);
  remainder_ = dense_->remainder();
  description_ = dense_->is_pivoted() ? "dense LU with pivoting" : "dense L L^T without pivoting";
  return x;
}

// Columns of norm 1 each, so that none is neglected beside others.
std::optional<std::vector<Complex>> EquationSolver::refined(std::vector<Complex> sides) {
  const std::size_t n = system_.unknowns();
  auto norms = column_norms(sides, n);
  std::replace(norms.begin(), norms.end(), 0.0, 1.0);
  for (std::size_t i = 0; i < sides.size(); ++i) sides[i] /= norms[i / n];
  const auto sums = combinations(sides, n);
  auto x = sides;
  fast_->solve(x);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0;; ++step) {
    remainder_ = subtracted(sums, combinations(x, n));
    const double now = relative_size(remainder_, sides, std::vector<double>(n, 1));
    description_ = "recursive skeletonization, refined " + std::to_string(step) +
                   " times, residual " + scientific(now);
    if (now <= tolerance_ / 2) break;
    if (!(now < before / 2)) return std::nullopt;
    before = now;
    auto correction = subtracted(sides, x);
    fast_->solve(correction);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += correction[i];
  }
  for (std::size_t i = 0; i < x.size(); ++i) x[i] *= norms[i / n];
  const double norm = root_mean_square(norms);
  for (Complex& left : remainder_) left *= norm;
  return x;
}

// With the fast factor as preconditioner.
std::vector<Complex> EquationSolver::by_gmres(const std::vector<Complex>& sides) {
  GmresOptions options{.tolerance = tolerance_};
  if (fast_)
    options.preconditioner = [this](std::span<const Complex> x) {
      std::vector<Complex> y(x.begin(), x.end());
      fast_->solve(y);
      return y;
    };
  auto result = gmres([this](std::span<const Complex> x) { return (*product_)(x); },
                      system_.unknowns(), sides, options);
  double worst = 0;
  for (double residual : result.residuals) worst = std::max(worst, residual);
  const int steps =
      result.steps.empty() ? 0 : *std::max_element(result.steps.begin(), result.steps.end());
  description_ = (fast_ ? "recursive skeletonization and block GMRES, " : "block GMRES, ") +
                 std::to_string(steps) + " fast products, residual " + scientific(worst);
  if (!(worst <= 100 * tolerance_))
    throw std::runtime_error("not solved: " + description_ + ", asked for " +
                             scientific(tolerance_) +
                             (fast_ ? "" : "; take --solver fast, which does not iterate"));
  const std::size_t n = system_.unknowns();
  remainder_ = subtracted(combinations(sides, n), combinations(result.x, n));
  return std::move(result.x);
}

// b - M x
std::vector<Complex> EquationSolver::subtracted(std::vector<Complex> b,
                                                const std::vector<Complex>& x) const {
  const auto y = (*product_)(x);
  for (std::size_t i = 0; i < b.size(); ++i) b[i] -= y[i];
  return b;
}

double EquationSolver::condition() const {
  return dense_ ? dense_->condition() : -1;
}

}  // namespace flatspeckle::wave
