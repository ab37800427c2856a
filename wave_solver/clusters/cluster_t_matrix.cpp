#include "wave_solver/clusters/cluster_t_matrix.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/scaled_bessel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/solutions/equation_solver.h"

namespace flatspeckle::wave {

namespace {

constexpr int most_orders = 1000;

double circle_radius(const Placement& cluster) {
  double radius = 0;
  for (std::size_t j = 0; j < cluster.size(); ++j)
    radius = std::max(radius, length(cluster[j].position) + cluster[j].scatterer.radius);
  return radius;
}

// The first order beyond which all waves are below the tolerance.
int series_order(double k, double radius, double gap, double tolerance) {
  const auto regular = scaled_bessel_j(most_orders, k * radius);
  const auto outgoing = scaled_hankel(most_orders, k * (radius + gap));
  int order = most_orders;
  const auto is_below = [&](int n) {
    const ScaledReal wave = abs(regular[n]);
    return wave.value() == 0 || (static_cast<double>(wave) <= tolerance &&
                                 static_cast<double>(wave * abs(outgoing[n])) <= tolerance);
  };
  while (order > 0 && is_below(order)) --order;
  if (order == most_orders)
    throw InputError("gap", number_text(gap),
                     "a circle of radius " + number_text(radius) + " needs more than " +
                         std::to_string(most_orders) + " orders; must be wider");
  return order;
}

std::vector<Mode> scaled_modes(double k, double radius, int order) {
  const auto regular = scaled_bessel_j(order + 1, k * radius);
  std::vector<ScaledReal> weight(order + 1);
  ScaledReal largest = abs(regular[order + 1]);
  for (int n = order; n >= 0; --n) {
    const ScaledReal size = abs(regular[n]);
    if (largest.value() == 0 || static_cast<double>(size / largest) > 1) largest = size;
    weight[n] = largest.value() > 0 ? largest : ScaledReal(1.0L);
  }
  std::vector<Mode> modes{{0, false, root_half * weight[0]}};
  for (int n = 1; n <= order; ++n)
    for (const bool odd : {false, true}) modes.push_back({n, odd, weight[n]});
  return modes;
}

}  // namespace

std::vector<Complex> ClusterTMatrix::turned(double angle) const {
  const std::size_t size = modes.size();
  std::vector<Complex> result = response;
  const auto turn = [&](Complex& even, Complex& odd, double phase) {
    const Complex first = even;
    even = std::cos(phase) * first - std::sin(phase) * odd;
    odd = std::sin(phase) * first + std::cos(phase) * odd;
  };
  for (std::size_t i = 1; i < size; i += 2)
    for (std::size_t j = 0; j < size; ++j)
      turn(result[i + size * j], result[i + 1 + size * j], modes[i].order * angle);
  for (std::size_t j = 1; j < size; j += 2)
    for (std::size_t i = 0; i < size; ++i)
      turn(result[i + size * j], result[i + size * (j + 1)], modes[j].order * angle);
  return result;
}

ClusterTMatrix cluster_waves(double k, double radius, double gap, int order) {
  return {k, radius, gap, order, scaled_modes(k, radius, order), {}};
}

// With V the regular waves about the origin in those about each scatterer, times sigma, the
// coefficients are beta = -M^-1 V, and V^T takes them back; V is divided by w.
ClusterTMatrix cluster_t_matrix(const Placement& cluster, double k, double gap, double tolerance) {
  if (!(gap > 0)) throw InputError("gap", number_text(gap), "must be positive");
  if (cluster.empty()) throw InputError("a cluster needs scatterers");
  const double radius = circle_radius(cluster);
  ClusterTMatrix result = cluster_waves(k, radius, gap, series_order(k, radius, gap, tolerance));
  auto inverse = result.modes;
  for (Mode& mode : inverse) {
    const ScaledReal one(1.0L);
    mode.weight = (mode.order == 0 ? ScaledReal(0.5L) : one) / mode.weight;
  }
  const TMatrixSystem system(cluster, k, tolerance);
  const std::size_t unknowns = system.unknowns(), size = inverse.size();
  std::vector<ModeSet> scatterers;
  for (std::size_t j = 0; j < cluster.size(); ++j) scatterers.push_back(system.modes(j));
  std::vector<Complex> waves(unknowns * size);
  translate_regular(k, scatterers, {{0, 0}, inverse, result.order}, {waves.data(), unknowns});
  const auto coefficients = EquationSolver(system, Method::automatic, tolerance / 10).solve(waves);
  result.response.resize(size * size);
  multiply(CblasTrans, CblasNoTrans, size, size, unknowns, -1, waves.data(), unknowns,
           coefficients.data(), unknowns, 0, result.response.data(), size);
  return result;
}

}  // namespace flatspeckle::wave
