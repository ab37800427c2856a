#include "mc/paths/estimators/gradient.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/estimators/single_scattering.h"
#include "mc/paths/estimators/slope_sums.h"
#include "mc/paths/estimators/sloped_ends.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Adds weight f_a conj(f_b) and its derivatives, [1 + parameter][entry].
class GradientTerms : public MediumSlopes, public SlopeSums {
 public:
  GradientTerms(const PathWalks& walks, std::span<const MediumSlope> slopes,
                std::span<Complex> sums)
      : MediumSlopes(walks, slopes),
        SlopeSums(walks.scene().request.channels.size(), walks.scene().request.entries,
                  slopes.size(), sums) {}

  void add_term(std::size_t c, Complex term, const LogSlopes& half, const SlopedEnds& lights,
                std::size_t i, const SlopedEnds& views, std::size_t v) {
    SlopeSums::add_term(
        c, term, [&](std::size_t p) { return half[p] + lights.slopes[i][p] + views.slopes[v][p]; });
  }
};

/// Fields with their first two derivatives by the number of scatterers, relative to it.
class FixedCountTerms : public MediumSlopes {
 public:
  FixedCountTerms(const PathWalks& walks, std::span<const MediumSlope> by_number,
                  std::span<Complex> sums)
      : MediumSlopes(walks, by_number),
        entries_(walks.scene().request.entries),
        sums_(sums),
        fields_(walks.scene().request.channels.size()) {}

  struct Inner {
    Complex half;
    int scatterers;
  };
  Inner inner(const GradientTally& tally, Vec2 first) const {
    return {MediumSlopes::inner(tally, first)[0], tally.scatterers};
  }
  Inner one(Vec2 x, Vec2 from, Vec2 to) const { return {MediumSlopes::one(x, from, to)[0], 1}; }

  void clear() { std::fill(fields_.begin(), fields_.end(), Field{}); }

  void add_term(std::size_t c, Complex term, const Inner& inner, const SlopedEnds& lights,
                std::size_t i, const SlopedEnds& views, std::size_t v) {
    const Complex slope = inner.half + lights.slopes[i][0] + views.slopes[v][0];
    fields_[c].value += term;
    fields_[c].slope += product(term, slope);
    fields_[c].curvature += product(term, product(slope, slope) - 0.5 * inner.scatterers);
  }

  void accumulate(double weight) {
    const std::size_t entries = entries_.size();
    for (std::size_t e = 0; e < entries; ++e) {
      const Field &a = fields_[entries_[e].a], &b = fields_[entries_[e].b];
      sums_[e] += weight * product_with_conjugate(a.value, b.value);
      sums_[entries + e] += weight * (product_with_conjugate(a.curvature, b.value) +
                                      product_with_conjugate(a.value, b.curvature) +
                                      2.0 * product_with_conjugate(a.slope, b.slope));
    }
  }

 private:
  struct Field {
    Complex value, slope, curvature;
  };

  const std::vector<Entry>& entries_;
  std::span<Complex> sums_;
  std::vector<Field> fields_;
};

/// Central differences in mu_t of the closed form, of fourth order. It varies over a mean free path
/// or the whole medium, whichever is less.
template <typename ClosedForm>
Values extinction_slope(const Scene& scene, const ClosedForm& closed_form) {
  const double mu_t = scene.medium.mu_t, across = std::max(scene.domain.depth, scene.domain.width),
               step = 1e-3 * mu_t / std::max(1.0, mu_t * across);
  Values slope(scene.request.entries.size());
  const auto add = [&](double steps, double factor) {
    Scene other = scene;
    other.medium.mu_t += steps * step;
    other.medium.mu_s = scene.medium.albedo * other.medium.mu_t;
    const Values values = closed_form(other);
    for (std::size_t e = 0; e < slope.size(); ++e) slope[e] += factor / (12 * step) * values[e];
  };
  add(1, 8);
  add(-1, -8);
  add(2, -1);
  add(-2, 1);
  return slope;
}

/// d log of the amplitudes' product of every entry.
Values amplitude_slopes(const Scene& scene, const AmplitudeSlope& slope) {
  Values slopes;
  for (const Entry entry : scene.request.entries) {
    const FarField a(scene, entry.a), b(scene, entry.b);
    slopes.push_back(slope(a.light, a.view) + std::conj(slope(b.light, b.view)));
  }
  return slopes;
}

/// Of paths of one scatterer.
Values single_gradient(const PathWalks& walks, const std::vector<MediumSlope>& slopes) {
  const Scene& scene = walks.scene();
  const auto closed_form = [&](const Scene& any) { return single_scattering(any, walks); };
  const Values single = closed_form(scene), by_mu_t = extinction_slope(scene, closed_form);
  Values all = single;
  for (const MediumSlope& slope : slopes) {
    const Values turned = amplitude_slopes(scene, slope.amplitude);
    const double mu_t = slope.log_mu_t * scene.medium.mu_t;
    for (std::size_t e = 0; e < single.size(); ++e)
      all.push_back(mu_t * by_mu_t[e] + product(single[e], turned[e] + slope.log_albedo));
  }
  return all;
}

}  // namespace

Plan gradient_plan(const Scene& scene, ReversedPaths reversed) {
  check_gradient(scene);
  Plan plan = make_plan(scene, reversed);
  plan.rank_k = false;
  if (plan.phase == Plan::Phase::isotropic && scene.scatterer.kind == Scatterer::Kind::hg)
    plan.phase = Plan::Phase::henyey_greenstein;
  return plan;
}

GradientJob gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  const auto parameters = bulk_parameters(scene);
  std::vector<MediumSlope> slopes;
  for (const BulkParameter parameter : parameters) slopes.push_back(medium_slope(scene, parameter));
  return gradient_job(slope_job(scene, plan, slopes, seed), parameters, scene);
}

PathJob slope_job(const Scene& scene, const Plan& plan, const std::vector<MediumSlope>& slopes,
                  std::uint64_t seed) {
  require_slopes(scene, slopes);
  const auto shared = std::make_shared<const std::vector<MediumSlope>>(slopes);
  return path_job({1 + slopes.size(),
                   [shared](const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<SlopeScorer<GradientTerms>>(
                         walks, GradientTally{*shared}, GradientTerms(walks, *shared, sums));
                   },
                   [shared](const PathWalks& walks) { return single_gradient(walks, *shared); }},
                  scene, plan, seed);
}

PathJob fixed_count_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  static const std::vector<MediumSlope> by_number = {{"number", 1, 0, {}}};
  require_slopes(scene, by_number);
  return path_job({2,
                   [](const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<SlopeScorer<FixedCountTerms>>(
                         walks, GradientTally{by_number}, FixedCountTerms(walks, by_number, sums));
                   }},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
