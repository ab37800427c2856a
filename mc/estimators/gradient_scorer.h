#pragma once

#include <span>

#include "flatland/scene/scene.h"
#include "mc/estimators/path_ends.h"
#include "mc/estimators/slope_sums.h"
#include "mc/estimators/sloped_ends.h"

namespace flatspeckle::mc {

/// Adds weight f_a conj(f_b) and its derivatives, [1 + parameter][entry].
template <typename Scattering, bool reversed, bool phases>
class GradientScorer {
  using Direction = typename Scattering::Direction;

 public:
  GradientScorer(const Scene& scene, const Scattering& scattering,
                 std::span<const MediumSlope> slopes, std::span<Complex> sums)
      : channels_(scene.request.channels),
        scattering_(scattering),
        slopes_(scene, scattering, slopes),
        sums_(channels_.size(), scene.request.entries, slopes.size(), sums),
        ends_(scene, [](std::size_t ends) { return SlopedEnds(ends); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    auto& [lights, views, light_first, light, view_first, view] = ends_;
    slopes_.attenuate(lights, x, light);
    slopes_.attenuate(views, x, view);
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      add_term(c, slopes_.half_of_one(from, to), light, view,
               local(scattering_, x).amplitude(from, to));
    }
    sums_.accumulate(weight);
  }

  void multiple(const TalliedPath<Direction, GradientTally>& path) {
    ends_.find(path, [this](auto& ends, Vec2 x, const Direction& arrival, SlopedEnds& out) {
      slopes_.at(ends, x, arrival, out);
    });
    const LogSlopes half = slopes_.half(path.tally);
    sums_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      add_term(c, half, ends_.light_first, ends_.view_last, 1.0);
      if constexpr (reversed) add_term(c, half, ends_.light_last, ends_.view_first, 1.0);
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
  const Scattering& scattering_;
  MediumSlopes<Scattering, phases> slopes_;
  SlopeSums sums_;
  PathEnds<SlopedEnds, reversed, phases> ends_;
};

}  // namespace flatspeckle::mc
