#include "wave_solver/solutions/equation_solver.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/skeletons/fast_direct.h"
#include "wave_solver/sums/fast_product.h"
#include "wave_solver/sums/gmres.h"

namespace flatspeckle::wave {

namespace {

constexpr double best_product = 1e-12;  // the least tolerance of FastProduct
constexpr double rough_factor = 1e-6;   // finer ones cost more than the refinement that they save

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

EquationSolver::EquationSolver(const TMatrixSystem& system, Method method, double tolerance)
    : system_(system), tolerance_(std::max(tolerance, best_product)) {
  if (method == Method::automatic) method = method_for(system.unknowns(), tolerance);
  if (method == Method::dense) {
    dense_ = std::make_unique<DenseFactor>(system.matrix(), system.unknowns());
    return;
  }
  product_ = std::make_unique<FastProduct>(system, std::max(tolerance_ / 10, best_product));
  if (method == Method::fast)
    fast_ = std::make_unique<FastDirect>(system, std::max(tolerance_, rough_factor));
}

EquationSolver::~EquationSolver() = default;

std::vector<Complex> EquationSolver::solve(const std::vector<Complex>& sides) {
  if (!dense_) return iterate(sides);
  auto x = dense_->solve(sides);
  description_ = dense_->is_pivoted() ? "dense LU with pivoting" : "dense L L^T without pivoting";
  return x;
}

// With the fast factor as preconditioner this is iterative refinement.
std::vector<Complex> EquationSolver::iterate(const std::vector<Complex>& sides) {
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
  description_ = (fast_ ? "recursive skeletonization, refined by " : "block GMRES, ") +
                 std::to_string(steps) + " fast products, residual " + scientific(worst);
  if (!(worst <= 100 * tolerance_))
    throw std::runtime_error("not solved: " + description_ + ", asked for " +
                             scientific(tolerance_) +
                             (fast_ ? "" : "; take --solver fast, which does not iterate"));
  return std::move(result.x);
}

std::vector<Complex> EquationSolver::product(const std::vector<Complex>& x) const {
  return product_ ? (*product_)(x) : system_.apply(x);
}

double EquationSolver::condition() const {
  return dense_ ? dense_->condition() : -1;
}

}  // namespace flatspeckle::wave
