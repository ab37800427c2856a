#include "mc/paths/estimators/gradient.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/derivative_endpoints.h"
#include "mc/paths/estimators/derivative_sums.h"
#include "mc/paths/estimators/single_scattering.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// The class Terms of DerivativeScorer that adds weight f_a conj(f_b) and its derivatives to the
/// sums, [1 + parameter][entry], where f_a and f_b are the two fields of an entry.
class GradientTerms : public MediumDerivatives, public DerivativeSums {
 public:
  GradientTerms(const PathWalks& walks, std::span<const MediumDerivative> derivatives,
                std::span<Complex> sums)
      : MediumDerivatives(walks, derivatives),
        DerivativeSums(walks.scene().request.channels.size(), walks.scene().request.entries,
                       derivatives.size(), sums) {}

  void add_term(std::size_t c, Complex term, const LogDerivatives& half,
                const DerivativeEndpoints& lights, std::size_t i, const DerivativeEndpoints& views,
                std::size_t v) {
    DerivativeSums::add_term(c, term, [&](std::size_t p) {
      return half[p] + lights.log_derivatives[i][p] + views.log_derivatives[v][p];
    });
  }
};

/// The class Terms of DerivativeScorer for fixed_count_job(): fields with their first two
/// derivatives with respect to the density rho, in units of rho.
class FixedCountTerms : public MediumDerivatives {
 public:
  FixedCountTerms(const PathWalks& walks, std::span<const MediumDerivative> by_number,
                  std::span<Complex> sums)
      : MediumDerivatives(walks, by_number),
        entries_(walks.scene().request.entries),
        sums_(sums),
        fields_(walks.scene().request.channels.size()) {}

  struct Inner {
    Complex half;
    int scatterers;
  };
  Inner inner(const GradientTally& tally, Vec first) const {
    return {MediumDerivatives::inner(tally, first)[0], tally.scatterers};
  }
  Inner one(Vec x, Vec from, Vec to) const { return {MediumDerivatives::one(x, from, to)[0], 1}; }

  void clear() { std::fill(fields_.begin(), fields_.end(), Field{}); }

  void add_term(std::size_t c, Complex term, const Inner& inner, const DerivativeEndpoints& lights,
                std::size_t i, const DerivativeEndpoints& views, std::size_t v) {
    const Complex log_derivative =
        inner.half + lights.log_derivatives[i][0] + views.log_derivatives[v][0];
    fields_[c].value += term;
    fields_[c].derivative += product(term, log_derivative);
    fields_[c].curvature +=
        product(term, product(log_derivative, log_derivative) - 0.5 * inner.scatterers);
  }

  void accumulate(double weight) {
    const std::size_t entries = entries_.size();
    for (std::size_t e = 0; e < entries; ++e) {
      const Field &a = fields_[entries_[e].a], &b = fields_[entries_[e].b];
      sums_[e] += weight * product_with_conjugate(a.value, b.value);
      sums_[entries + e] += weight * (product_with_conjugate(a.curvature, b.value) +
                                      product_with_conjugate(a.value, b.curvature) +
                                      2.0 * product_with_conjugate(a.derivative, b.derivative));
    }
  }

 private:
  struct Field {
    Complex value, derivative, curvature;
  };

  const std::vector<Entry>& entries_;
  std::span<Complex> sums_;
  std::vector<Field> fields_;
};

/// Differentiates the closed form of single scattering with respect to mu_t by fourth-order central
/// differences. It varies over changes of mu_t of the order of mu_t or of 1 / (extent of the
/// medium), whichever is smaller.
template <typename ClosedForm>
Values extinction_derivative(const Scene& scene, const ClosedForm& closed_form) {
  const double mu_t = scene.medium.mu_t, across = std::max(scene.domain.depth, scene.domain.width),
               step = 1e-3 * mu_t / std::max(1.0, mu_t * across);
  Values derivative(scene.request.entries.size());
  const auto add = [&](double steps, double factor) {
    Scene other = scene;
    other.medium.mu_t += steps * step;
    other.medium.mu_s = scene.medium.albedo * other.medium.mu_t;
    const Values values = closed_form(other);
    for (std::size_t e = 0; e < derivative.size(); ++e)
      derivative[e] += factor / (12 * step) * values[e];
  };
  add(1, 8);
  add(-1, -8);
  add(2, -1);
  add(-2, 1);
  return derivative;
}

/// Returns, for every entry, the logarithmic derivative of the product of the amplitudes of its two
/// fields.
Values amplitude_derivatives(const Scene& scene, const AmplitudeDerivative& derivative) {
  Values derivatives;
  for (const Entry entry : scene.request.entries) {
    const FarField a(scene, entry.a), b(scene, entry.b);
    derivatives.push_back(derivative(a.light, a.view) + std::conj(derivative(b.light, b.view)));
  }
  return derivatives;
}

/// Returns the contribution of paths of one scatterer to the quantities of derivative_job(), in
/// closed form.
Values single_gradient(const PathWalks& walks, const std::vector<MediumDerivative>& derivatives) {
  const Scene& scene = walks.scene();
  const auto closed_form = [&](const Scene& any) { return single_scattering(any, walks); };
  const Values single = closed_form(scene), by_mu_t = extinction_derivative(scene, closed_form);
  Values all = single;
  for (const MediumDerivative& derivative : derivatives) {
    const Values turned = amplitude_derivatives(scene, derivative.amplitude);
    const double mu_t = derivative.log_mu_t * scene.medium.mu_t;
    for (std::size_t e = 0; e < single.size(); ++e)
      all.push_back(mu_t * by_mu_t[e] + product(single[e], turned[e] + derivative.log_albedo));
  }
  return all;
}

}  // namespace

Plan gradient_plan(const Scene& scene, ReversedPaths reversed) {
  check_gradient(scene);
  Plan plan = make_plan(scene, reversed);
  plan.rank_k = false;
  if (scene.scatterer.kind == Scatterer::Kind::hg) {
    // isotropic scattering has no derivative by g
    if (plan.phase == Plan::Phase::isotropic) plan.phase = Plan::Phase::henyey_greenstein;
    if (plan.phase == Plan::Phase::isotropic_in_space)
      plan.phase = Plan::Phase::henyey_greenstein_in_space;
  }
  return plan;
}

GradientJob gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  const auto parameters = bulk_parameters(scene);
  std::vector<MediumDerivative> derivatives;
  for (const BulkParameter parameter : parameters)
    derivatives.push_back(medium_derivative(scene, parameter));
  return gradient_job(derivative_job(scene, plan, derivatives, seed), parameters, scene);
}

PathJob derivative_job(const Scene& scene, const Plan& plan,
                       const std::vector<MediumDerivative>& derivatives, std::uint64_t seed) {
  require_derivatives(scene, derivatives);
  const auto shared = std::make_shared<const std::vector<MediumDerivative>>(derivatives);
  return path_job({1 + derivatives.size(),
                   [shared](const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<DerivativeScorer<GradientTerms>>(
                         walks, GradientTally{*shared}, GradientTerms(walks, *shared, sums));
                   },
                   [shared](const PathWalks& walks) { return single_gradient(walks, *shared); }},
                  scene, plan, seed);
}

PathJob fixed_count_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  static const std::vector<MediumDerivative> by_number = {{"number", 1, 0, {}}};
  require_derivatives(scene, by_number);
  return path_job({2,
                   [](const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<DerivativeScorer<FixedCountTerms>>(
                         walks, GradientTally{by_number}, FixedCountTerms(walks, by_number, sums));
                   }},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
