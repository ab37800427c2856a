#include <memory>
#include <vector>

#include "mc/paths/estimators/gradient.h"
#include "mc/paths/estimators/path_ends.h"
#include "mc/paths/estimators/scored_paths.h"
#include "mc/paths/estimators/sloped_ends.h"

namespace flatspeckle::mc {

namespace {

/// Fields with their first two derivatives by the number of scatterers, relative to it.
class FixedCountScorer : public TallyScorer<GradientTally> {
 public:
  FixedCountScorer(const PathWalks& walks, std::span<const MediumSlope> by_number,
                   std::span<Complex> sums)
      : TallyScorer(GradientTally{by_number}),
        request_(walks.scene().request),
        scattering_(walks.scattering()),
        slopes_(walks, by_number),
        sums_(sums),
        fields_(request_.channels.size()),
        ends_(walks, [](std::size_t ends) { return SlopedEnds(ends); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) override {
    EndFactors &lights = ends_.lights(), &views = ends_.views();
    auto &light = ends_.light_last, &view = ends_.view_last;
    slopes_.attenuate(lights, x, light);
    slopes_.attenuate(views, x, view);
    for (std::size_t c = 0; c < fields_.size(); ++c) {
      const auto [i, v] = request_.channels[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      fields_[c] = {};
      add_term(c, slopes_.half_of_one(from, to)[0], light, view, 1,
               scattering_.amplitude(x, from, to));
    }
    accumulate(weight);
  }

  void multiple(const Path& path) override {
    ends_.find(path, [this](EndFactors& ends, Vec2 x, const SpaceDirection& arrival,
                            SlopedEnds& out) { slopes_.at(ends, x, arrival, out); });
    const Complex half = slopes_.half(tally())[0];
    for (std::size_t c = 0; c < fields_.size(); ++c) {
      fields_[c] = {};
      add_term(c, half, ends_.light_first, ends_.view_last, tally().scatterers, 1.0);
      if (ends_.reversed())
        add_term(c, half, ends_.light_last, ends_.view_first, tally().scatterers, 1.0);
    }
    accumulate(path.weight);
  }

 private:
  struct Field {
    Complex value, slope, curvature;
  };

  template <typename Amplitude>
  void add_term(std::size_t c, Complex half, const SlopedEnds& lights, const SlopedEnds& views,
                int scatterers, Amplitude amplitude) {
    const auto [i, v] = request_.channels[c];
    const Complex term = product(product(lights.value[i], views.value[v]), amplitude),
                  slope = half + lights.slopes[i][0] + views.slopes[v][0];
    fields_[c].value += term;
    fields_[c].slope += product(term, slope);
    fields_[c].curvature += product(term, product(slope, slope) - 0.5 * scatterers);
  }

  void accumulate(double weight) {
    const std::size_t entries = request_.entries.size();
    for (std::size_t e = 0; e < entries; ++e) {
      const Field &a = fields_[request_.entries[e].a], &b = fields_[request_.entries[e].b];
      sums_[e] += weight * product_with_conjugate(a.value, b.value);
      sums_[entries + e] += weight * (product_with_conjugate(a.curvature, b.value) +
                                      product_with_conjugate(a.value, b.curvature) +
                                      2.0 * product_with_conjugate(a.slope, b.slope));
    }
  }

  const CovarianceRequest& request_;
  const EndScattering& scattering_;
  MediumSlopes slopes_;
  std::span<Complex> sums_;
  std::vector<Field> fields_;
  PathEnds<SlopedEnds> ends_;
};

}  // namespace

PathJob fixed_count_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  static const std::vector<MediumSlope> by_number = {{"number", 1, 0, {}}};
  require_slopes(scene, by_number);
  return path_job({2,
                   [](const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<FixedCountScorer>(walks, by_number, sums);
                   }},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
