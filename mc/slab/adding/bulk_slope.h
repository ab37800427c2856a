#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/algebra/dual.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/slab/adding/phase_moments.h"

namespace flatspeckle::mc {

/// Of the moments of a law: the last of them.
inline int degree(const std::vector<double>& moments) {
  return static_cast<int>(moments.size()) - 1;
}
inline int degree(const Dual<std::vector<double>>& moments) {
  return std::max(degree(moments.value), degree(moments.slope));
}

/// A scattering law with its derivative by the logarithm of what its scatterers are, or by g.
template <typename Law>
class SlopeOf {
 public:
  /// A law next to it, and its weight in a difference.
  struct Neighbour {
    double weight;
    Law law;
  };

  /// Does not know of the parameter.
  explicit SlopeOf(const Law& law)
      : law_(law),
        moments_{law.moments(), std::vector<double>(law.moments().size())},
        peak_{law.peak(), 0} {}

  SlopeOf(const Law& law, std::vector<Neighbour> neighbours) : SlopeOf(law) {
    neighbours_ = std::move(neighbours);
    auto& moments = moments_.slope;
    for (const auto& [weight, near] : neighbours_) {
      moments.resize(std::max(moments.size(), near.moments().size()));
      for (std::size_t m = 0; m < near.moments().size(); ++m)
        moments[m] += weight * near.moments()[m];
      peak_.slope += weight * near.peak();
    }
  }

  /// Of Henyey-Greenstein's function without delay, by g: its moments are g^m.
  static SlopeOf by_g(const Law& law, double g) {
    SlopeOf slope(law);
    slope.by_g_ = true;
    slope.g_ = g;
    auto& moments = slope.moments_.slope;
    moments.assign(law.moments().size() + 1, 0);
    for (std::size_t m = 1; m < moments.size(); ++m)
      moments[m] = static_cast<double>(m) * std::pow(g, static_cast<double>(m - 1));
    const KeptMoments& kept = law.kept();
    if (kept.tail == 0) return slope;
    if (kept.peak > 0) slope.peak_.slope = kept.peak_degree * std::pow(g, kept.peak_degree - 1);
    moments.pop_back();
    for (std::size_t m = 0; m < moments.size(); ++m)
      moments[m] = kept.less_peak(m, moments[m], slope.peak_.slope);
    return slope;
  }

  SlopeOf truncated(int count) const {
    const Law law = law_.truncated(count);
    if (by_g_) return by_g(law, g_);
    std::vector<Neighbour> near;
    for (const auto& [weight, own] : neighbours_) near.push_back({weight, own.truncated(count)});
    return SlopeOf(law, std::move(near));
  }

  /// turns: as those of the law's own pair().
  template <typename... Turns>
  auto pair(Turns... turns) const {
    const auto value = law_.pair(turns...);
    Dual<std::remove_const_t<decltype(value)>> pair{value, 0};
    if (by_g_) pair.slope = law_.pair_slope(g_, turns...) * value;
    for (const auto& [weight, near] : neighbours_) pair.slope += weight * near.pair(turns...);
    return pair;
  }
  const Dual<std::vector<double>>& moments() const { return moments_; }
  const Dual<double>& peak() const { return peak_; }
  bool has_sharp_peak() const { return law_.has_sharp_peak(); }
  double width() const { return law_.width(); }
  int least_order() const { return law_.least_order(); }

 private:
  Law law_;
  bool by_g_ = false;
  double g_ = 0;
  std::vector<Neighbour> neighbours_;
  Dual<std::vector<double>> moments_;
  Dual<double> peak_;
};

/// A scattering law of calculations with a Number.
template <typename Geometry, typename Number>
using LawOf = std::conditional_t<std::is_same_v<Number, Dual<double>>,
                                 SlopeOf<typename Geometry::Law>, typename Geometry::Law>;

/// What a change of one parameter does to a slab's medium, a scattering law with its derivative
/// among it. Derivatives are by parameter/unit: those by a logarithm are as large as the values.
template <typename Law>
struct BulkSlopeOf {
  double unit, log_mu_t, albedo;
  SlopeOf<Law> law;
};

/// The radius, or the real part of the index, by which a scatterer is differentiated.
inline double scatterer_unit(const Scatterer& scatterer, BulkParameter parameter) {
  return parameter == BulkParameter::radius ? scatterer.radius : scatterer.index.real();
}
inline Scatterer with_size(Scatterer scatterer, BulkParameter parameter, double factor) {
  if (parameter == BulkParameter::radius)
    scatterer.radius *= factor;
  else
    scatterer.index.real(scatterer.index.real() * factor);
  return scatterer;
}

/// The unit of derivatives by a parameter.
inline double unit_of(const Scene& scene, BulkParameter parameter) {
  switch (parameter) {
    case BulkParameter::mu_t:
      return scene.medium.mu_t;
    case BulkParameter::albedo:
      return scene.medium.albedo;
    case BulkParameter::g:
      return 1;
    default:
      return scatterer_unit(scene.scatterer, parameter);
  }
}

/// By what describes the scatterers as a bulk: mu_t, albedo, g. By the logarithm of a scatterer's
/// radius or index, by differences of fourth order, to 1e-10 or so. law: the scene's.
template <typename Geometry>
BulkSlopeOf<typename Geometry::Law> bulk_slope(const Scene& scene,
                                               const typename Geometry::Law& law,
                                               BulkParameter parameter) {
  using Slope = SlopeOf<typename Geometry::Law>;
  const BulkMedium& bulk = scene.medium;
  const double unit = unit_of(scene, parameter);
  if (parameter == BulkParameter::mu_t) return {unit, 1, 0, Slope(law)};
  if (parameter == BulkParameter::albedo) return {unit, 0, bulk.albedo, Slope(law)};
  if (parameter == BulkParameter::g) return {unit, 0, 0, Slope::by_g(law, bulk.g)};
  const Scatterer& scatterer = scene.scatterer;
  const double size = scene.k * scatterer.radius * std::abs(scatterer.index),
               step = 1e-3 / std::max(1.0, size);
  double log_mu_t = 0, albedo = 0;
  std::vector<typename Slope::Neighbour> neighbours;
  for (const auto& [steps, factor] : {std::pair(1, 8), {-1, -8}, {2, -1}, {-2, 1}}) {
    const double weight = factor / (12 * step);
    const Scene near =
        Geometry::with_scatterer(scene, with_size(scatterer, parameter, 1 + steps * step));
    log_mu_t += weight * near.medium.mu_t / bulk.mu_t;
    albedo += weight * near.medium.albedo;
    neighbours.push_back({weight, Geometry::law(near)});
  }
  return {unit, log_mu_t, albedo, Slope(law, std::move(neighbours))};
}

}  // namespace flatspeckle::mc
