#include "wave_solver/clusters/cluster_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/bessel.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/dense/dense_factor.h"
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

// Returns the lowest order beyond which both |J_n(k radius)| and |J_n(k radius) H_n(k (radius +
// gap))| are below the tolerance.
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
                     "a circle of radius " + number_text(radius) + " requires more than " +
                         std::to_string(most_orders) + " orders; use a wider gap");
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

std::string text_of(const ClusterPlace& place) {
  return "(" + number_text(place.centre.x) + ", " + number_text(place.centre.z) + ")";
}

// Throws InputError if two clusters are too close. Sorts by x, so that only close clusters are
// compared.
void require_apart(const ClusterTMatrix& cluster, std::vector<ClusterPlace> places) {
  const double least = (2 * cluster.radius + cluster.gap) * (1 - 1e-12);
  std::ranges::sort(places, {}, [](const ClusterPlace& place) { return place.centre.x; });
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = i; j-- > 0 && places[i].centre.x - places[j].centre.x < least;)
      if (const double distance = length(places[i].centre - places[j].centre); distance < least)
        throw InputError(
            "distance of the clusters at " + text_of(places[j]) + " and " + text_of(places[i]),
            number_text(distance),
            "must be at least " + number_text(least) + ", the radii of both circles plus the gap");
}

// Returns sigma_n / w_n (ScaledInverse) of each mode: the square root of the diagonal element of
// |response|, averaged over cos(n phi) and sin(n phi).
std::vector<double> sizes_of(const ClusterTMatrix& cluster) {
  const std::size_t size = cluster.modes.size();
  const auto own = [&](std::size_t i) { return std::abs(cluster.response[i * (size + 1)]); };
  std::vector<double> sizes{std::sqrt(own(0))};
  for (std::size_t i = 1; i < size; i += 2)
    sizes.insert(sizes.end(), 2, std::sqrt((own(i) + own(i + 1)) / 2));
  // Sizes must not be 0, even if nothing scatters.
  for (double& one : sizes) one = std::max(one, std::sqrt(std::numeric_limits<double>::min()));
  return sizes;
}

// Returns the largest amplitude of each mode in a field: w_n for the regular wave, or w_n |H_n| for
// the outgoing wave at the smallest distance allowed, whichever is larger.
std::vector<double> amplitudes_of(const ClusterTMatrix& cluster) {
  const auto outgoing = scaled_hankel(cluster.order, cluster.k * (cluster.radius + cluster.gap));
  std::vector<double> amplitudes;
  for (const Mode& mode : cluster.modes)
    amplitudes.push_back(std::max(static_cast<double>(mode.weight),
                                  static_cast<double>(mode.weight * abs(outgoing[mode.order]))));
  return amplitudes;
}

std::vector<Complex> inverted(Entries matrix, std::size_t size) {
  std::vector<Complex> columns(size * size);
  for (std::size_t i = 0; i < size; ++i) columns[i * (size + 1)] = 1;
  return DenseFactor(std::move(matrix), size).solve(columns);
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

// The matrix V (`waves`) expands the regular waves about the origin, divided by w, in the regular
// waves about each scatterer, times sigma. The coefficients of the scatterers are then beta = -M^-1
// V, and V^T transforms them to outgoing waves about the origin, also divided by w.
ClusterTMatrix cluster_t_matrix(const Placement& cluster, double k, double gap, double tolerance) {
  if (!(gap > 0)) throw InputError("gap", number_text(gap), "must be positive");
  if (cluster.empty()) throw InputError("a cluster must contain at least one scatterer");
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

namespace {

// Returns the relative difference between the response and the matrix that results from inverting
// the response twice. Elements are weighted by amplitudes_of() their modes.
double inversion_error_of(const ClusterTMatrix& cluster, const ScaledInverse& found) {
  const auto& sigma = found.sizes;
  const std::size_t size = sigma.size();
  const auto back = inverted({found.inverse.begin(), found.inverse.end()}, size);
  const auto amplitude = amplitudes_of(cluster);
  double error_square = 0, all = 0;
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i) {
      const Complex whole = cluster.response[i + size * j];
      const double weight = amplitude[i] * amplitude[j];
      error_square += std::norm(weight * (whole + sigma[i] * sigma[j] * back[i + size * j]));
      all += std::norm(weight * whole);
    }
  return all > 0 ? std::sqrt(error_square / all) : 0;
}

}  // namespace

// The real part of the inverted matrix is positive semidefinite, like that of M. If the matrix is
// singular, because some orders hardly scatter, the inversion error remains infinite.
ScaledInverse scaled_inverse(const ClusterTMatrix& cluster) {
  ScaledInverse found{sizes_of(cluster), {}, std::numeric_limits<double>::infinity()};
  const auto& sigma = found.sizes;
  const std::size_t size = sigma.size();
  Entries scaled(size * size);
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i)
      scaled[i + size * j] = -cluster.response[i + size * j] / (sigma[i] * sigma[j]);
  try {
    found.inverse = inverted(std::move(scaled), size);
    found.inversion_error = inversion_error_of(cluster, found);
  } catch (const std::runtime_error&) {
  }
  return found;
}

void ClusterEquations::add_copies(const ClusterTMatrix& own,
                                  const std::vector<ClusterPlace>& places) {
  require_apart(own, places);
  std::map<double, OwnBlock> turned;
  for (const auto& [centre, angle] : places) {
    OwnBlock& block = turned[angle];
    if (!block) block = std::make_shared<const std::vector<Complex>>(own.turned(angle));
    add({centre, own.radius}, own.modes, block);
  }
}

ClusterEquations::ClusterEquations(const ClusterTMatrix& cluster,
                                   const std::vector<ClusterPlace>& places,
                                   const ScaledInverse& inverse)
    : WaveEquations(cluster.k), have_inverse_(true) {
  ClusterTMatrix own = cluster;
  for (std::size_t i = 0; i < own.modes.size(); ++i)
    own.modes[i].weight = own.modes[i].weight * ScaledReal(inverse.sizes[i]);
  own.response = inverse.inverse;
  add_copies(own, places);
}

ClusterEquations::ClusterEquations(const ClusterTMatrix& cluster,
                                   const std::vector<ClusterPlace>& places)
    : WaveEquations(cluster.k), have_inverse_(false) {
  ClusterTMatrix own = cluster;
  own.response.assign(own.response.size(), 0);
  add_copies(own, places);
}

}  // namespace flatspeckle::wave
