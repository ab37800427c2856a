#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/request.h"
#include "mc/paths/estimators/path_ends.h"

namespace flatspeckle::mc {

/// Fields of a path with their derivatives by some parameters, and the sums of
/// weight f_a conj(f_b) and its derivatives, [1 + parameter][entry].
class SlopeSums {
 public:
  /// entries: pairs of so many fields.
  SlopeSums(std::size_t fields, std::span<const Entry> entries, std::size_t parameters,
            std::span<Complex> sums)
      : entries_(entries),
        parameters_(parameters),
        sums_(sums),
        field_(fields),
        field_slope_(field_.size() * parameters) {}

  void clear() {
    std::fill(field_.begin(), field_.end(), 0);
    std::fill(field_slope_.begin(), field_slope_.end(), 0);
  }

  /// A term of a field; slope(p): its logarithmic derivative by parameter p.
  template <typename Slope>
  void add_term(std::size_t c, Complex term, const Slope& slope) {
    field_[c] += term;
    for (std::size_t p = 0; p < parameters_; ++p)
      field_slope_[p * field_.size() + c] += product(term, slope(p));
  }

  void accumulate(double weight) {
    const std::size_t entries = entries_.size();
    for (std::size_t e = 0; e < entries; ++e) {
      const auto [a, b] = entries_[e];
      sums_[e] += weight * product_with_conjugate(field_[a], field_[b]);
      for (std::size_t p = 0; p < parameters_; ++p) {
        const Complex* slope = &field_slope_[p * field_.size()];
        sums_[(1 + p) * entries + e] += weight * (product_with_conjugate(slope[a], field_[b]) +
                                                  product_with_conjugate(field_[a], slope[b]));
      }
    }
  }

 private:
  std::span<const Entry> entries_;
  std::size_t parameters_;
  std::span<Complex> sums_;
  std::vector<Complex> field_;        ///< of each
  std::vector<Complex> field_slope_;  ///< its derivatives, [parameter][field]
};

/// Scores the fields of paths with their derivatives. Terms: how the fields of a path's channels
/// are made and summed,
///   Tally, Ends                         of a path; of a list of ends, with A e of each as `value`
///   ends(n)                             Ends of n of them
///   attenuate(ends, x, out)             from x to the ends, without scattering there
///   turn(ends, x, arrival, out)         adds what scattering at x towards the ends does
///   inner(tally, first), one(x, w, w2)  what a path has besides its ends, of B >= 2 and of B = 1
///   clear(), add_term(channel, term, inner, lights, i, views, v), accumulate(weight)
template <typename Terms>
class SlopeScorer : public TallyScorer<typename Terms::Tally> {
  using Ends = typename Terms::Ends;

 public:
  SlopeScorer(const PathWalks& walks, const typename Terms::Tally& none, Terms terms)
      : TallyScorer<typename Terms::Tally>(none),
        channels_(walks.scene().request.channels),
        walks_(walks),
        terms_(std::move(terms)),
        ends_(walks, [this](std::size_t ends) { return terms_.ends(ends); }) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) override {
    EndFactors &lights = ends_.lights(), &views = ends_.views();
    Ends &light = ends_.light_last, &view = ends_.view_last;
    terms_.attenuate(lights, x, light);
    terms_.attenuate(views, x, view);
    terms_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec2 from = -lights.direction(i), to = views.direction(v);
      terms_.add_term(
          c, product(product(light.value[i], view.value[v]), walks_.amplitude(x, from, to)),
          terms_.one(x, from, to), light, i, view, v);
    }
    terms_.accumulate(weight);
  }

  void multiple(const Path& path) override {
    ends_.find(path, [this](EndFactors& ends, Vec2 x, const SpaceDirection& arrival, Ends& out) {
      terms_.attenuate(ends, x, out);
      walks_.towards(x, arrival, ends.directions(), out.value);
      terms_.turn(ends, x, arrival, out);
    });
    const auto& inner = terms_.inner(this->tally(), path.first);
    terms_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      add_term(c, inner, ends_.light_first, ends_.view_last);
      if (ends_.reversed()) add_term(c, inner, ends_.light_last, ends_.view_first);
    }
    terms_.accumulate(path.weight);
  }

 private:
  template <typename Inner>
  void add_term(std::size_t c, const Inner& inner, const Ends& lights, const Ends& views) {
    const auto [i, v] = channels_[c];
    terms_.add_term(c, product(lights.value[i], views.value[v]), inner, lights, i, views, v);
  }

  const std::vector<Channel>& channels_;
  const PathWalks& walks_;
  Terms terms_;
  PathEnds<Ends> ends_;
};

}  // namespace flatspeckle::mc
