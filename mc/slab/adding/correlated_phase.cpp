#include "mc/slab/adding/correlated_phase.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mc/slab/adding/phase_moments.h"

namespace flatspeckle::mc {

namespace {

/// Returns an upper bound of S on [0, last], less than 1e-6 above its maximum: the largest of
/// equidistant values, refined by a ternary search between its neighbours.
double largest_value(const StructureFactor& structure, double last) {
  constexpr int steps = 16384;  // resolve the principal peak up to size parameters of 500
  constexpr double margin = 1 + 1e-9;
  const double step = last / steps;
  int best = 0;
  double largest = 0;
  for (int i = 0; i <= steps; ++i)
    if (const double value = structure(i * step); value > largest) {
      largest = value;
      best = i;
    }
  double low = std::max(0, best - 1) * step, high = std::min(steps, best + 1) * step;
  for (int i = 0; i < 60; ++i) {
    const double third = (high - low) / 3, left = structure(low + third),
                 right = structure(high - third);
    (left < right ? low : high) = left < right ? low + third : high - third;
    largest = std::max({largest, left, right});
  }
  return margin * largest;
}

}  // namespace

CorrelatedPhase::CorrelatedPhase(grin::MiePhase alone, StructureFactor structure, double k)
    : alone_(std::move(alone)),
      structure_(std::move(structure)),
      k_(k),
      largest_(largest_value(structure_, 2 * k)) {
  const auto scattered = [this](double angle) { return density(std::cos(angle)); };
  const double mean = sphere_integral(scattered);
  // The integrand 1 + cos does not change sign, so that the tolerance of the quadrature is
  // relative.
  const double forward =
      sphere_integral([&](double angle) { return (1 + std::cos(angle)) * scattered(angle); });
  mean_structure_ = mean;
  mean_cosine_ = forward / mean - 1;
}

double CorrelatedPhase::structure_at(double one_minus_cosine) const {
  return structure_(k_ * std::sqrt(2 * std::max(0.0, one_minus_cosine)));
}

double CorrelatedPhase::one_minus_cosine(RandomStream& random) const {
  while (true) {
    const double turn = alone_.one_minus_cosine(random);
    if (random.uniform() * largest_ < structure_at(turn)) return turn;
  }
}

}  // namespace flatspeckle::mc
