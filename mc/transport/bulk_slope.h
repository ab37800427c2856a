#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/algebra/dual.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/transport/scattering_law.h"

namespace flatspeckle::mc {

/// Of the modes or moments of a law: the last of them.
inline int degree(const std::vector<double>& modes) {
  return static_cast<int>(modes.size()) - 1;
}
inline int degree(const Dual<std::vector<double>>& modes) {
  return std::max(degree(modes.value), degree(modes.slope));
}

/// Of g^m, m = 0 .. count - 1: derivatives by g.
std::vector<double> power_slopes(double g, std::size_t count);

/// A scattering law with its derivative by the logarithm of what its scatterers are, or by g.
class ScatteringSlope {
 public:
  /// A law next to it, and its weight in a difference.
  struct Neighbour {
    double weight;
    ScatteringLaw law;
  };

  /// Does not know of the parameter.
  explicit ScatteringSlope(const ScatteringLaw& law);
  /// Of Henyey-Greenstein's function by g.
  static ScatteringSlope by_g(const ScatteringLaw& law, double g);
  ScatteringSlope(const ScatteringLaw& law, std::vector<Neighbour> neighbours);

  Dual<Complex> pair(double a, double b, double theta) const;
  const Dual<std::vector<double>>& modes() const { return modes_; }

 private:
  const ScatteringLaw& law_;
  bool by_g_ = false;
  std::vector<Neighbour> neighbours_;
  Dual<std::vector<double>> modes_;
};

/// What a change of one parameter does to a slab's medium, a scattering law with its derivative
/// among it. Derivatives are by parameter/unit: those by a logarithm are as large as the values.
template <typename Slope>
struct BulkSlopeOf {
  double unit, log_mu_t, albedo;
  Slope law;
};
using BulkSlope = BulkSlopeOf<ScatteringSlope>;

/// By what describes the scatterers as a bulk: mu_t, albedo, g.
template <typename Slope, typename Law>
BulkSlopeOf<Slope> bulk_slope_of(const BulkMedium& medium, const Law& law,
                                 BulkParameter parameter) {
  if (parameter == BulkParameter::mu_t) return {medium.mu_t, 1, 0, Slope(law)};
  if (parameter == BulkParameter::albedo) return {medium.albedo, 0, medium.albedo, Slope(law)};
  return {1, 0, 0, Slope::by_g(law, medium.g)};
}

/// The radius, or the real part of the index, by which a scatterer is differentiated.
double scatterer_unit(const Scatterer& scatterer, BulkParameter parameter);
Scatterer with_size(Scatterer scatterer, BulkParameter parameter, double factor);

/// By the logarithm of a scatterer's radius or index, by differences of fourth order, to 1e-10 or
/// so. at(scatterer): a pair of its medium and law.
template <typename Slope, typename Law, typename At>
BulkSlopeOf<Slope> scatterer_slope(const Scene& scene, const Law& law, BulkParameter parameter,
                                   const At& at) {
  const Scatterer& scatterer = scene.scatterer;
  const double size = scene.k * scatterer.radius * std::abs(scatterer.index),
               step = 1e-3 / std::max(1.0, size);
  double log_mu_t = 0, albedo = 0;
  std::vector<typename Slope::Neighbour> neighbours;
  for (const auto& [steps, factor] : {std::pair(1, 8), {-1, -8}, {2, -1}, {-2, 1}}) {
    const double weight = factor / (12 * step);
    auto [medium, near] = at(with_size(scatterer, parameter, 1 + steps * step));
    log_mu_t += weight * medium.mu_t / scene.medium.mu_t;
    albedo += weight * medium.albedo;
    neighbours.push_back({weight, std::move(near)});
  }
  return {scatterer_unit(scatterer, parameter), log_mu_t, albedo,
          Slope(law, std::move(neighbours))};
}

/// law: the scene's, and outlives the slope.
BulkSlope bulk_slope(const Scene& scene, const ScatteringLaw& law, BulkParameter parameter);

/// By what transport differentiates: bulk_parameters(), and of spheres the radius and the index.
std::vector<BulkParameter> slab_parameters(const Scene& scene);

template <typename Number>
struct LawNumbers {
  using Law = ScatteringLaw;
};
template <>
struct LawNumbers<Dual<double>> {
  using Law = ScatteringSlope;
};
/// A scattering law of calculations with a Number.
template <typename Number>
using LawOf = typename LawNumbers<Number>::Law;

}  // namespace flatspeckle::mc
