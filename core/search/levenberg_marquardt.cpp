#include "core/search/levenberg_marquardt.h"

#include <algorithm>
#include <limits>
#include <map>

#include "core/numbers/symmetric.h"
#include "core/run/stopwatch.h"

namespace flatspeckle {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Normal equations of a step. Parameters at a bound that would move beyond it are kept fixed.
struct NormalEquations {
  MatrixXd matrix;
  VectorXd descent;

  NormalEquations(const BoundedLeastSquares& problem, const LeastSquaresFit& at)
      : matrix(at.jacobian.transpose() * at.jacobian),
        descent(-at.jacobian.transpose() * at.residuals) {
    for (Index i = 0; i < descent.size(); ++i) {
      const bool held = (at.parameters[i] <= problem.lower[i] && descent[i] < 0) ||
                        (at.parameters[i] >= problem.upper[i] && descent[i] > 0);
      if (held) leave_out(i);
    }
  }

  VectorXd step(double damping) const {
    MatrixXd damped = matrix;
    damped.diagonal() *= 1 + damping;
    return solve_symmetric(damped, descent);
  }

 private:
  void leave_out(Index i) {
    matrix.row(i).setZero();
    matrix.col(i).setZero();
    matrix(i, i) = 1;
    descent[i] = 0;
  }
};

VectorXd within(const BoundedLeastSquares& problem, const VectorXd& parameters) {
  return parameters.cwiseMax(problem.lower).cwiseMin(problem.upper);
}

}  // namespace

VectorXd damped_step(const BoundedLeastSquares& problem, const LeastSquaresFit& at,
                     double damping) {
  return within(problem, at.parameters + NormalEquations(problem, at).step(damping)) -
         at.parameters;
}

LeastSquaresFit levenberg_marquardt(const BoundedLeastSquares& problem, const VectorXd& start,
                                    int most_iterations, double tolerance) {
  constexpr double first_damping = 1e-3, most_damping = 1e12, factor = 10;
  LeastSquaresFit at;
  at.parameters = within(problem, start);
  at.residuals = problem.residuals(at.parameters);
  at.jacobian = problem.jacobian(at.parameters, at.residuals);
  const auto note = [&] {
    at.trace.push_back({at.parameters, at.chi_squared(), process_cpu_seconds()});
  };
  note();
  double damping = first_damping;
  for (; at.iterations < most_iterations && damping < most_damping; ++at.iterations) {
    const VectorXd step = damped_step(problem, at, damping), next = at.parameters + step;
    at.converged = (at.jacobian * step).squaredNorm() < tolerance && damping <= 1;
    if (at.converged) return at;
    const VectorXd residuals = problem.residuals(next);
    const double gain = at.chi_squared() - residuals.squaredNorm();
    if (!(gain >= 0)) {
      damping *= factor;
      continue;
    }
    at.parameters = next;
    at.residuals = residuals;
    at.jacobian = problem.jacobian(next, residuals);
    note();
    at.converged = gain < tolerance && damping <= 1;
    if (at.converged) return at;
    damping = std::max(damping / factor, 1e-12);
  }
  return at;
}

std::optional<Invariant> check_derivative(const BoundedLeastSquares& problem,
                                          const LeastSquaresFit& fit) {
  const VectorXd range = problem.upper - problem.lower;
  Index i = 0;
  (fit.jacobian * range.asDiagonal()).colwise().norm().maxCoeff(&i);
  constexpr double step = 1e-3;
  const double width = step * range[i], size = fit.jacobian.col(i).norm();
  VectorXd below = fit.parameters, above = below;
  below[i] -= width;
  above[i] += width;
  if (!(size > 0) || below[i] < problem.lower[i] || above[i] > problem.upper[i])
    return std::nullopt;
  const VectorXd low = problem.residuals(below), high = problem.residuals(above);
  // Allowed relative difference due to rounding errors of the residuals and their higher
  // derivatives.
  constexpr double rounding = 1e-3;
  const double bent = (high + low - 2 * fit.residuals).norm() / (2 * width);
  return Invariant{(fit.jacobian.col(i) - (high - low) / (2 * width)).norm() / size,
                   rounding + 2 * bent / size};
}

MatrixXd jacobian(const BoundedLeastSquares& problem, const VectorXd& at, const VectorXd& here,
                  double step) {
  MatrixXd derivatives(here.size(), at.size());
  for (Index i = 0; i < at.size(); ++i) {
    const double range = problem.upper[i] - problem.lower[i],
                 sign = 2 * at[i] > problem.lower[i] + problem.upper[i] ? -1 : 1;
    VectorXd next = at;
    next[i] += sign * step * range;
    derivatives.col(i) = (problem.residuals(next) - here) / (next[i] - at[i]);
  }
  return derivatives;
}

std::vector<VectorXd> best_starts(const BoundedLeastSquares& problem,
                                  const std::vector<VectorXd>& starts, std::size_t most) {
  std::multimap<double, VectorXd> by_chi_squared;
  for (const VectorXd& start : starts)
    by_chi_squared.emplace(problem.residuals(within(problem, start)).squaredNorm(), start);
  std::vector<VectorXd> best;
  for (const auto& [chi_squared, start] : by_chi_squared)
    if (best.size() < most) best.push_back(start);
  return best;
}

LeastSquaresFit best_fit(const BoundedLeastSquares& problem, const std::vector<VectorXd>& starts,
                         int most_iterations, double tolerance) {
  std::vector<LeastSquaresFit> fits;
  for (const VectorXd& start : starts)
    fits.push_back(levenberg_marquardt(problem, start, most_iterations, tolerance));
  return *std::min_element(fits.begin(), fits.end(), [](const auto& a, const auto& b) {
    return a.converged != b.converged ? a.converged : a.chi_squared() < b.chi_squared();
  });
}

double expected_chi_squared(const MatrixXd& errors, const MatrixXd& jacobian) {
  const MatrixXd inverse = inverse_symmetric(jacobian.transpose() * jacobian);
  const double fitted = (inverse * jacobian.transpose() * errors * jacobian).trace();
  return std::max(errors.trace() - fitted, 0.0);
}

Information information(const BoundedLeastSquares& problem, const MatrixXd& jacobian) {
  return information_of(problem, jacobian.transpose() * jacobian);
}

Information information_of(const BoundedLeastSquares& problem, const MatrixXd& fisher) {
  const VectorXd range = problem.upper - problem.lower;
  const auto [known, combinations] =
      symmetric_eigen(range.asDiagonal() * fisher * range.asDiagonal());
  const Index last = known.size() - 1;
  Information found;
  found.worst = combinations.col(0);
  found.best = combinations.col(last);
  // corresponds to an error of a million times the distance of the bounds
  constexpr double nothing = 1e-12;
  const double least = std::max(nothing, known[last] * std::numeric_limits<double>::epsilon());
  const bool all_known = known[0] > least;
  found.condition = all_known ? known[last] / known[0] : std::numeric_limits<double>::infinity();
  const VectorXd at_least = known.cwiseMax(least).cwiseSqrt().cwiseInverse();
  const MatrixXd root = range.asDiagonal() * combinations * at_least.asDiagonal();
  found.covariance = root * root.transpose();
  const VectorXd inverse = found.errors().cwiseInverse();
  found.correlation = inverse.asDiagonal() * found.covariance * inverse.asDiagonal();
  return found;
}

}  // namespace flatspeckle
