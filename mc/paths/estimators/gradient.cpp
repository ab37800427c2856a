#include "mc/paths/estimators/gradient.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "mc/paths/estimators/path_ends.h"
#include "mc/paths/estimators/scored_paths.h"
#include "mc/paths/estimators/single_scattering.h"
#include "mc/paths/estimators/slope_sums.h"
#include "mc/paths/estimators/sloped_ends.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Adds weight f_a conj(f_b) and its derivatives, [1 + parameter][entry].
class GradientScorer : public TallyScorer<GradientTally> {
 public:
  GradientScorer(const PathWalks& walks, std::span<const MediumSlope> slopes,
                 std::span<Complex> sums)
      : TallyScorer(GradientTally{slopes}),
        channels_(walks.scene().request.channels),
        scattering_(walks.scattering()),
        slopes_(walks, slopes),
        sums_(channels_.size(), walks.scene().request.entries, slopes.size(), sums),
        ends_(walks, [](std::size_t ends) { return SlopedEnds(ends); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) override {
    EndFactors &lights = ends_.lights(), &views = ends_.views();
    SlopedEnds &light = ends_.light_last, &view = ends_.view_last;
    slopes_.attenuate(lights, x, light);
    slopes_.attenuate(views, x, view);
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      add_term(c, slopes_.half_of_one(from, to), light, view, scattering_.amplitude(x, from, to));
    }
    sums_.accumulate(weight);
  }

  void multiple(const Path& path) override {
    ends_.find(path, [this](EndFactors& ends, Vec2 x, const SpaceDirection& arrival,
                            SlopedEnds& out) { slopes_.at(ends, x, arrival, out); });
    const LogSlopes half = slopes_.half(tally());
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      add_term(c, half, ends_.light_first, ends_.view_last, 1.0);
      if (ends_.reversed()) add_term(c, half, ends_.light_last, ends_.view_first, 1.0);
    }
    sums_.accumulate(path.weight);
  }

 private:
  template <typename Amplitude>
  void add_term(std::size_t c, const LogSlopes& half, const SlopedEnds& lights,
                const SlopedEnds& views, Amplitude amplitude) {
    const auto [i, v] = channels_[c];
    sums_.add_term(c, product(product(lights.value[i], views.value[v]), amplitude),
                   [&, light = i, view = v](std::size_t p) {
                     return half[p] + lights.slopes[light][p] + views.slopes[view][p];
                   });
  }

  const std::vector<Channel>& channels_;
  const EndScattering& scattering_;
  MediumSlopes slopes_;
  SlopeSums sums_;
  PathEnds<SlopedEnds> ends_;
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
  const auto closed_form = [&](const Scene& any) {
    return single_scattering(any, walks.scattering());
  };
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
                     return std::make_unique<GradientScorer>(walks, *shared, sums);
                   },
                   [shared](const PathWalks& walks) { return single_gradient(walks, *shared); }},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
