#include "wave_solver/basis_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/bessel.h"
#include "core/error.h"

namespace flatspeckle::wave {

namespace {

using Magnitudes = std::vector<long double>;

constexpr double nowhere = std::numeric_limits<double>::infinity();

// What is close to a scatterer.
struct Surroundings {
  std::size_t neighbour = 0;  // the one whose images come closest; itself if alone
  double distance = nowhere;  // of their centres
  double source = nowhere;    // of those images
  double receiver = nowhere;  // nearest near-field sensor
};

// T_n per distinct scatterer, as far as asked for up to now.
class TMatrices {
 public:
  TMatrices(const Placement& placement, double k) : k_(k), kind_(placement.size()) {
    for (std::size_t j = 0; j < placement.size(); ++j) {
      const Scatterer& scatterer = placement[j].scatterer;
      if (scatterer.kind == Scatterer::Kind::hg)
        throw InputError("scatterer", "hg", "the wave solver needs point, soft, hard, tm or te");
      const auto known = std::find(scatterers_.begin(), scatterers_.end(), scatterer);
      kind_[j] = known - scatterers_.begin();
      if (known == scatterers_.end()) scatterers_.push_back(scatterer);
    }
    t_.resize(scatterers_.size());
  }

  const std::vector<ExtendedComplex>& of(std::size_t j, int order) {
    auto& t = t_[kind_[j]];
    if (static_cast<int>(t.size()) <= order) t = t_matrix(scatterers_[kind_[j]], k_, order);
    return t;
  }

 private:
  double k_;
  std::vector<std::size_t> kind_;
  std::vector<Scatterer> scatterers_;
  std::vector<std::vector<ExtendedComplex>> t_;
};

Surroundings surroundings(const Placement& placement, std::size_t j,
                          std::span<const Vec2> sensors) {
  Surroundings around{.neighbour = j};
  for (std::size_t l = 0; l < placement.size(); ++l) {
    if (l == j) continue;
    const double distance = length(placement[l].position - placement[j].position);
    const double source =
        nearest_image(placement[j].scatterer.disk_radius(), placement[l].scatterer.disk_radius(), distance);
    if (source < around.source) {
      around.neighbour = l;
      around.distance = distance;
      around.source = source;
    }
  }
  for (const Vec2& sensor : sensors)
    around.receiver = std::min(around.receiver, length(sensor - placement[j].position));
  return around;
}

// |H_n(k distance)|, n = 0 .. order
Magnitudes reach(int order, double k, double distance) {
  Magnitudes magnitudes(order + 1, 0);
  if (distance == nowhere) return magnitudes;
  const auto h = hankel(order, k * distance);
  std::transform(h.begin(), h.end(), magnitudes.begin(),
                 [](const ExtendedComplex& h_n) { return std::abs(h_n); });
  return magnitudes;
}

// The bound w_n of the header.
Magnitudes waves_of_neighbour(const Placement& placement, double k, std::size_t j,
                              const Surroundings& around, int order, TMatrices& t_matrices) {
  Magnitudes bound = reach(order, k, around.source);
  const std::size_t l = around.neighbour;
  if (l == j || !placement[l].scatterer.is_disk()) return bound;
  const auto& t = t_matrices.of(l, order);
  const double image =
      nearest_image(placement[l].scatterer.disk_radius(), placement[j].scatterer.disk_radius(), around.distance);
  Magnitudes sent = reach(order, k, image);
  for (int m = 0; m <= order; ++m) sent[m] = std::abs(t[m]) * std::max(1.0L, sent[m]);
  const Magnitudes translation = reach(2 * order, k, around.distance);
  for (int n = 0; n <= order; ++n)
    for (int m = 0; m <= order; ++m) {
      const long double wave = sent[m] * translation[n + m];
      if (wave > bound[n] && std::isfinite(wave)) bound[n] = wave;
    }
  return bound;
}

[[noreturn]] void refuse(const PlacedScatterer& placed) {
  throw InputError("radius", placed.scatterer.radius,
                   "the disk at (" + std::to_string(placed.position.x) + ", " +
                       std::to_string(placed.position.z) +
                       ") is so close to a neighbour or sensor, for its size in wavelengths, that "
                       "its expansion leaves the range of numbers; widen the gap (min_gap)");
}

// What w_n leaves out (further neighbours, many orders adding up), from pairs and clusters with
// gaps from 1e-3 to 0.5 radii and k a up to 30; between hard disks the error grows with k a.
double safety(const Scatterer& scatterer, double k) {
  const double x = scatterer.kind == Scatterer::Kind::hard ? k * scatterer.radius : 0;
  return 30 * (1 + x * x);
}

// The order, if t is long enough to tell.
std::optional<int> order_within(const PlacedScatterer& placed, double k, double tolerance,
                                const std::vector<ExtendedComplex>& t, const Magnitudes& source,
                                const Magnitudes& receiver) {
  constexpr int settled = 3;
  constexpr long double smallest = std::numeric_limits<long double>::min() * 1e20L;
  const int size = static_cast<int>(source.size()) - 1;
  const int first = oscillating_order(placed.scatterer, k);
  long double largest = 0;
  for (const auto& t_n : t) largest = std::max(largest, std::abs(t_n));
  if (largest == 0) return 0;
  int order = 0;
  for (int n = 0; n <= size; ++n) {
    const long double strength = std::abs(t[n]), in = std::max(1 / largest, source[n]),
                      out = std::max({1.0L, source[n], receiver[n]});
    if (n > first && (strength < smallest || !std::isfinite(in) || !std::isfinite(out)))
      refuse(placed);
    if (strength * in * out > tolerance / safety(placed.scatterer, k)) order = n;
    if (n > first && n >= order + settled) return order;
  }
  return std::nullopt;
}

int basis_order(const Placement& placement, double k, double tolerance, std::size_t j,
                const Surroundings& around, TMatrices& t_matrices) {
  if (!placement[j].scatterer.is_disk()) return 0;
  for (int size = oscillating_order(placement[j].scatterer, k) + 16;; size *= 2) {
    const auto source = waves_of_neighbour(placement, k, j, around, size, t_matrices);
    const auto receiver = reach(size, k, around.receiver);
    const auto order =
        order_within(placement[j], k, tolerance, t_matrices.of(j, size), source, receiver);
    if (order) return *order;
  }
}

}  // namespace

double nearest_image(double a, double b, double d) {
  const double sum = a + b, difference = a - b;
  const double c = std::sqrt((d - sum) * (d + sum) * (d - difference) * (d + difference)) / (2 * d);
  return c + std::hypot(c, a);
}

std::vector<std::vector<ExtendedComplex>> basis(const Placement& placement, double k,
                                                double tolerance, std::span<const Vec2> sensors) {
  TMatrices t_matrices(placement, k);
  std::vector<std::vector<ExtendedComplex>> basis(placement.size());
  for (std::size_t j = 0; j < placement.size(); ++j) {
    const Surroundings around = placement[j].scatterer.is_disk()
                                    ? surroundings(placement, j, sensors)
                                    : Surroundings{.neighbour = j};
    const int order = basis_order(placement, k, tolerance, j, around, t_matrices);
    const auto& t = t_matrices.of(j, order);
    basis[j].assign(t.begin(), t.begin() + order + 1);
  }
  return basis;
}

}  // namespace flatspeckle::wave
