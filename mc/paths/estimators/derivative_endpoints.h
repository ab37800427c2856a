#pragma once

#include <array>
#include <span>
#include <vector>

#include "mc/paths/estimators/medium_derivative.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Tally of what determines the logarithmic derivatives of the integrand of a path. The integrand
/// is mu_s^B prod exp(-mu_t r) prod p, where B is the number of scatterers, r the length of a
/// flight and p the phase function.
struct GradientTally {
  std::span<const MediumDerivative> derivatives;
  int scatterers = 1;
  double length = 0;
  /// Derivative of log p with respect to each parameter, summed over the inner scatterers.
  std::array<double, most_derivatives> phase_derivative{};

  void flight(Vec, Vec, double r) {
    length += r;
    ++scatterers;
  }
  void scattering(Vec, Vec from, Vec to) {
    for (std::size_t p = 0; p < derivatives.size(); ++p)
      if (derivatives[p].amplitude.depends())
        phase_derivative[p] += 2 * derivatives[p].amplitude(from, to).real();
  }
};

/// Logarithmic derivatives of a quantity with respect to each parameter.
using LogDerivatives = std::array<Complex, most_derivatives>;

/// The product A e of C14 (amplitude and endpoint factor) for every endpoint, and the logarithmic
/// derivatives of this product.
struct DerivativeEndpoints {
  std::vector<Complex> value;
  std::vector<LogDerivatives> log_derivatives;

  explicit DerivativeEndpoints(std::size_t endpoints)
      : value(endpoints), log_derivatives(endpoints) {}
};

/// Derivatives of paths and of their endpoint factors with respect to parameters of the medium, for
/// DerivativeScorer. The logarithmic derivative of a term of a field (F or R of C14) is half of the
/// logarithmic derivative of the path without its endpoints, plus the logarithmic derivatives of A
/// e for its two endpoints.
class MediumDerivatives {
 public:
  using Tally = GradientTally;
  using Endpoints = DerivativeEndpoints;

  MediumDerivatives(const PathWalks& walks, std::span<const MediumDerivative> derivatives)
      : medium_(walks.scene().medium), derivatives_(derivatives) {}

  DerivativeEndpoints endpoints(std::size_t count) const { return DerivativeEndpoints(count); }

  void attenuate(EndpointFactors& endpoints, Vec x, DerivativeEndpoints& out) const {
    endpoints.attenuate(x, out.value);
    for (std::size_t p = 0; p < derivatives_.size(); ++p)
      for (std::size_t j = 0; j < endpoints.size(); ++j)
        out.log_derivatives[j][p] = derivatives_[p].log_mu_t * endpoints.log_attenuation(j);
  }

  void turn(const EndpointFactors& endpoints, Vec, Vec arrival, DerivativeEndpoints& out) const {
    for (std::size_t p = 0; p < derivatives_.size(); ++p) {
      const AmplitudeDerivative& amplitude = derivatives_[p].amplitude;
      if (!amplitude.depends()) continue;
      for (std::size_t j = 0; j < endpoints.size(); ++j)
        out.log_derivatives[j][p] += amplitude(arrival, endpoints.direction(j));
    }
  }

  LogDerivatives inner(const GradientTally& tally, Vec) const {
    const double by_mu_t = tally.scatterers - medium_.mu_t * tally.length;
    LogDerivatives half{};
    for (std::size_t p = 0; p < derivatives_.size(); ++p)
      half[p] = (derivatives_[p].log_mu_t * by_mu_t +
                 derivatives_[p].log_albedo * tally.scatterers + tally.phase_derivative[p]) /
                2;
    return half;
  }

  LogDerivatives one(Vec x, Vec from, Vec to) const {
    LogDerivatives one = inner({derivatives_}, x);
    for (std::size_t p = 0; p < derivatives_.size(); ++p)
      if (derivatives_[p].amplitude.depends()) one[p] += derivatives_[p].amplitude(from, to);
    return one;
  }

 private:
  const BulkMedium& medium_;
  std::span<const MediumDerivative> derivatives_;
};

}  // namespace flatspeckle::mc
