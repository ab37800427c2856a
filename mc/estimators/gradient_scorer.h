#pragma once

#include <span>

#include "flatland/scene/scene.h"
#include "mc/estimators/path_ends.h"
#include "mc/estimators/slope_sums.h"
#include "mc/estimators/sloped_ends.h"

namespace flatspeckle::mc {

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

}  // namespace flatspeckle::mc
