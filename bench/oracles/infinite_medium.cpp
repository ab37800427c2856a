#include "bench/oracles/infinite_medium.h"

#include <cmath>
#include <numbers>

#include "bench/oracles/quadrature.h"

namespace flatspeckle::oracles {

namespace {

/// The root of albedo atanh(kappa) = kappa, in (0, 1): by bisection.
double decay(double albedo) {
  double low = 0, high = 1;
  for (int i = 0; i < 200; ++i) {
    const double kappa = (low + high) / 2;
    (kappa > 0 && albedo * std::atanh(kappa) < kappa ? low : high) = kappa;
  }
  return low;
}

/// 4 pi r times the part of the pole, mu_t = 1.
double diffusing(double albedo, double r) {
  const double kappa = decay(albedo), square = kappa * kappa;
  return 2 * square * (1 - square) * std::exp(-kappa * r) / (albedo * (square - (1 - albedo)));
}

/// The same of the cut: integral of exp(-r t) g(t) over t > 1.
double transient(double albedo, double r) {
  Quadrature beyond_1;
  for (double from = 1e-14; from < 60 / r; from *= 4) beyond_1.add(from, 4 * from);
  double sum = 0;
  for (std::size_t i = 0; i < beyond_1.node.size(); ++i) {
    const double s = beyond_1.node[i], t = 1 + s;
    const double real = 1 - albedo / t * 0.5 * std::log((2 + s) / s);
    const double imaginary = std::numbers::pi * albedo / (2 * t);
    sum += beyond_1.weight[i] * std::exp(-r * t) / (real * real + imaginary * imaginary);
  }
  return sum;
}

}  // namespace

double point_source_fluence(double mu_t, double albedo, double r) {
  const double depth = mu_t * r;
  return mu_t * (diffusing(albedo, depth) + transient(albedo, depth)) / (4 * std::numbers::pi * r);
}

}  // namespace flatspeckle::oracles
