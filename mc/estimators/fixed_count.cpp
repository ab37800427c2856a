#include "mc/estimators/fixed_count.h"

#include <cassert>
#include <memory>
#include <vector>

#include "mc/estimators/path_ends.h"
#include "mc/estimators/sloped_ends.h"

namespace flatspeckle::mc {

namespace {

/// Fields with their first two derivatives by the number of scatterers, relative to it.
template <typename Scattering, bool reversed, bool phases>
class FixedCountScorer {
  using Direction = typename Scattering::Direction;

 public:
  FixedCountScorer(const Scene& scene, const Scattering& scattering,
                   std::span<const MediumSlope> by_number, std::span<Complex> sums)
      : request_(scene.request),
        scattering_(scattering),
        slopes_(scene, scattering, by_number),
        sums_(sums),
        fields_(request_.channels.size()),
        ends_(scene, [](std::size_t ends) { return SlopedEnds(ends); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    auto& [lights, views, light_first, light, view_first, view] = ends_;
    slopes_.attenuate(lights, x, light);
    slopes_.attenuate(views, x, view);
    for (std::size_t c = 0; c < fields_.size(); ++c) {
      const auto [i, v] = request_.channels[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      fields_[c] = {};
      add_term(c, slopes_.half_of_one(from, to)[0], light, view, 1,
               local(scattering_, x).amplitude(from, to));
    }
    accumulate(weight);
  }

  void multiple(const TalliedPath<Direction, GradientTally>& path) {
    ends_.find(path, [this](auto& ends, Vec2 x, const Direction& arrival, SlopedEnds& out) {
      slopes_.at(ends, x, arrival, out);
    });
    const Complex half = slopes_.half(path.tally)[0];
    for (std::size_t c = 0; c < fields_.size(); ++c) {
      fields_[c] = {};
      add_term(c, half, ends_.light_first, ends_.view_last, path.tally.scatterers, 1.0);
      if constexpr (reversed)
        add_term(c, half, ends_.light_last, ends_.view_first, path.tally.scatterers, 1.0);
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
  const Scattering& scattering_;
  MediumSlopes<Scattering, phases> slopes_;
  std::span<Complex> sums_;
  std::vector<Field> fields_;
  PathEnds<SlopedEnds, reversed, phases> ends_;
};

struct FixedCountKind {
  using Sums = std::span<Complex>;
  std::shared_ptr<const std::vector<MediumSlope>> by_number;

  std::size_t quantities() const { return 2; }

  GradientTally tally(const Scene&) const { return {*by_number}; }

  template <bool reversed, bool phases, typename Scattering>
  auto scorer(const Scene& scene, const Scattering& scattering, Sums sums) const {
    return FixedCountScorer<Scattering, reversed, phases>(scene, scattering, *by_number, sums);
  }

  /// Walks sample these paths.
  template <typename Scattering>
  std::vector<Complex> single(const Scene&, const Scattering&) const {
    return {};
  }
};

}  // namespace

PathJob fixed_count_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  assert(!scene.profile && plan.sampled_single);
  const std::vector<MediumSlope> by_number = {{"number", 1, 0, {}}};
  return path_job(FixedCountKind{std::make_shared<const std::vector<MediumSlope>>(by_number)},
                  scene, plan, seed);
}

}  // namespace flatspeckle::mc
