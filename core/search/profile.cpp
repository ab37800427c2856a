#include "core/search/profile.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace flatspeckle {

namespace {

using Eigen::VectorXd;

/// Distance of parameter i from its estimate, and the square root of the rise of chi^2 there.
struct Probe {
  double distance, root;
};

/// Returns the distance at which the root is expected to be `target`.
double next_distance(const std::optional<Probe>& within, const std::optional<Probe>& beyond,
                     double target) {
  constexpr double most = 2.5;
  if (!within) return beyond->distance * std::max(target / beyond->root, 1 / most);
  if (!beyond)
    return within->distance * std::min(target / std::max(within->root, target / most), most);
  return within->distance + (beyond->distance - within->distance) * (target - within->root) /
                                (beyond->root - within->root);
}

}  // namespace

VectorXd profile_end(const BoundedLeastSquares& problem, const LeastSquaresFit& fit, Eigen::Index i,
                     double side, double rise) {
  constexpr double quadratic = 0.4, precision = 0.03, tolerance = 0.01;
  constexpr int most_probes = 10, most_iterations = 20;
  const double target = std::sqrt(rise), estimate = fit.parameters[i],
               reach = side > 0 ? problem.upper[i] - estimate : estimate - problem.lower[i];
  const Eigen::MatrixXd covariance = information(problem, fit.jacobian).covariance;
  const VectorXd one_error = side * covariance.col(i) / std::sqrt(covariance(i, i));
  VectorXd end =
      (fit.parameters + target * one_error).cwiseMax(problem.lower).cwiseMin(problem.upper);
  double distance = std::abs(end[i] - estimate);
  const auto rise_of = [&](const VectorXd& residuals) {
    return residuals.squaredNorm() - fit.chi_squared();
  };
  if (distance < reach && std::abs(rise_of(problem.residuals(end)) - rise) < quadratic * rise)
    return end;
  std::optional<Probe> within, beyond;
  for (int probe = 0; probe < most_probes && distance > 0; ++probe) {
    BoundedLeastSquares held = problem;
    held.lower[i] = held.upper[i] = estimate + side * distance;
    const LeastSquaresFit best = levenberg_marquardt(held, end, most_iterations, tolerance);
    end = best.parameters;
    const double root = std::sqrt(std::max(rise_of(best.residuals), 0.0));
    if (std::abs(root - target) < precision * target) return end;
    (root < target ? within : beyond) = {distance, root};
    if (root < target && distance >= reach) return end;
    distance = std::min(next_distance(within, beyond, target), reach);
  }
  return end;
}

}  // namespace flatspeckle
