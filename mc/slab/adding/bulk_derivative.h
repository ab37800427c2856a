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

/// Returns the degree of the last moment in a list of moments of a phase function.
inline int degree(const std::vector<double>& moments) {
  return static_cast<int>(moments.size()) - 1;
}
inline int degree(const Dual<std::vector<double>>& moments) {
  return std::max(degree(moments.value), degree(moments.derivative));
}

/// A scattering law (ScatteringLaw or SpaceLaw) and its derivative by g, or by the logarithm of the
/// radius or of the refractive index of the scatterers.
template <typename Law>
class DerivativeOf {
 public:
  /// The scattering law at a neighbouring value of the parameter, and its weight in a finite
  /// difference.
  struct Neighbour {
    double weight;
    Law law;
  };

  /// Constructs a law that does not depend on the parameter; its derivative is 0.
  explicit DerivativeOf(const Law& law)
      : law_(law),
        moments_{law.moments(), std::vector<double>(law.moments().size())},
        peak_{law.peak(), 0} {}

  DerivativeOf(const Law& law, std::vector<Neighbour> neighbours) : DerivativeOf(law) {
    neighbours_ = std::move(neighbours);
    auto& moments = moments_.derivative;
    for (const auto& [weight, near] : neighbours_) {
      moments.resize(std::max(moments.size(), near.moments().size()));
      for (std::size_t m = 0; m < near.moments().size(); ++m)
        moments[m] += weight * near.moments()[m];
      peak_.derivative += weight * near.peak();
    }
  }

  /// Returns the Henyey-Greenstein law, whose moments are g^m, with its derivative by g. `law` must
  /// have delay 0: both fields of a pair are fields at the same time.
  static DerivativeOf by_g(const Law& law, double g) {
    DerivativeOf law_by_g(law);
    law_by_g.by_g_ = true;
    law_by_g.g_ = g;
    auto& moments = law_by_g.moments_.derivative;
    moments.assign(law.moments().size() + 1, 0);
    for (std::size_t m = 1; m < moments.size(); ++m)
      moments[m] = static_cast<double>(m) * std::pow(g, static_cast<double>(m - 1));
    const KeptMoments& kept = law.kept();
    if (kept.tail == 0) return law_by_g;
    if (kept.peak > 0)
      law_by_g.peak_.derivative = kept.peak_degree * std::pow(g, kept.peak_degree - 1);
    moments.pop_back();
    for (std::size_t m = 0; m < moments.size(); ++m)
      moments[m] = kept.less_peak(m, moments[m], law_by_g.peak_.derivative);
    return law_by_g;
  }

  DerivativeOf truncated(int count) const {
    const Law law = law_.truncated(count);
    if (by_g_) return by_g(law, g_);
    std::vector<Neighbour> near;
    for (const auto& [weight, own] : neighbours_) near.push_back({weight, own.truncated(count)});
    return DerivativeOf(law, std::move(near));
  }

  /// Returns the value of Law::pair() and its derivative by the parameter. turns: arguments of
  /// Law::pair().
  template <typename... Turns>
  auto pair(Turns... turns) const {
    const auto value = law_.pair(turns...);
    Dual<std::remove_const_t<decltype(value)>> pair{value, 0};
    if (by_g_) pair.derivative = law_.pair_derivative(g_, turns...) * value;
    for (const auto& [weight, near] : neighbours_) pair.derivative += weight * near.pair(turns...);
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

/// Type of the scattering law for calculations with this type of Number: DerivativeOf for
/// Dual<double>, otherwise the law without derivative.
template <typename Geometry, typename Number>
using LawOf = std::conditional_t<std::is_same_v<Number, Dual<double>>,
                                 DerivativeOf<typename Geometry::Law>, typename Geometry::Law>;

/// Derivatives of the properties of a slab's medium by p / unit, where p is one parameter. If unit
/// is the value of p, they are derivatives by the logarithm of p, which are of the order of the
/// properties themselves.
template <typename Law>
struct BulkDerivativeOf {
  double unit, log_mu_t, albedo;
  DerivativeOf<Law> law;
};

/// Returns the unit for derivatives by the radius or by the index of a scatterer: the radius, or
/// the real part of the index.
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

/// Returns BulkDerivativeOf::unit for a parameter: the value of the parameter in the scene, or 1
/// for g.
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

/// Returns the derivatives of the medium of a scene by a parameter. Derivatives by mu_t, albedo and
/// g are exact. Derivatives by the radius or the index of a scatterer are finite differences of
/// fourth order, with errors of about 1e-10. law: scattering law of the scene.
template <typename Geometry>
BulkDerivativeOf<typename Geometry::Law> bulk_derivative(const Scene& scene,
                                                         const typename Geometry::Law& law,
                                                         BulkParameter parameter) {
  using Derivative = DerivativeOf<typename Geometry::Law>;
  const BulkMedium& bulk = scene.medium;
  const double unit = unit_of(scene, parameter);
  if (parameter == BulkParameter::mu_t) return {unit, 1, 0, Derivative(law)};
  if (parameter == BulkParameter::albedo) return {unit, 0, bulk.albedo, Derivative(law)};
  if (parameter == BulkParameter::g) return {unit, 0, 0, Derivative::by_g(law, bulk.g)};
  const Scatterer& scatterer = scene.scatterer;
  const double size = scene.k * scatterer.radius * std::abs(scatterer.index),
               step = 1e-3 / std::max(1.0, size);
  double log_mu_t = 0, albedo = 0;
  std::vector<typename Derivative::Neighbour> neighbours;
  for (const auto& [steps, factor] : {std::pair(1, 8), {-1, -8}, {2, -1}, {-2, 1}}) {
    const double weight = factor / (12 * step);
    const Scene near =
        Geometry::with_scatterer(scene, with_size(scatterer, parameter, 1 + steps * step));
    log_mu_t += weight * near.medium.mu_t / bulk.mu_t;
    albedo += weight * near.medium.albedo;
    neighbours.push_back({weight, Geometry::law(near)});
  }
  return {unit, log_mu_t, albedo, Derivative(law, std::move(neighbours))};
}

}  // namespace flatspeckle::mc
