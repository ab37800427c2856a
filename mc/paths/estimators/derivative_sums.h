#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/request.h"
#include "mc/paths/estimators/path_endpoints.h"

namespace flatspeckle::mc {

/// Fields of a path with their derivatives with respect to parameters. accumulate() adds weight f_a
/// conj(f_b), where f_a and f_b are the two fields of an entry, and its derivatives to the sums, [1
/// + parameter][entry].
class DerivativeSums {
 public:
  /// fields: number of fields; every entry is a pair of them.
  DerivativeSums(std::size_t fields, std::span<const Entry> entries, std::size_t parameters,
                 std::span<Complex> sums)
      : entries_(entries),
        parameters_(parameters),
        sums_(sums),
        field_(fields),
        field_derivative_(field_.size() * parameters) {}

  void clear() {
    std::fill(field_.begin(), field_.end(), 0);
    std::fill(field_derivative_.begin(), field_derivative_.end(), 0);
  }

  /// Adds `term` to field c. log_derivative(p): logarithmic derivative of the term with respect to
  /// parameter p.
  template <typename LogDerivative>
  void add_term(std::size_t c, Complex term, const LogDerivative& log_derivative) {
    field_[c] += term;
    for (std::size_t p = 0; p < parameters_; ++p)
      field_derivative_[p * field_.size() + c] += product(term, log_derivative(p));
  }

  void accumulate(double weight) {
    const std::size_t entries = entries_.size();
    for (std::size_t e = 0; e < entries; ++e) {
      const auto [a, b] = entries_[e];
      sums_[e] += weight * product_with_conjugate(field_[a], field_[b]);
      for (std::size_t p = 0; p < parameters_; ++p) {
        const Complex* derivative = &field_derivative_[p * field_.size()];
        sums_[(1 + p) * entries + e] += weight * (product_with_conjugate(derivative[a], field_[b]) +
                                                  product_with_conjugate(field_[a], derivative[b]));
      }
    }
  }

 private:
  std::span<const Entry> entries_;
  std::size_t parameters_;
  std::span<Complex> sums_;
  std::vector<Complex> field_;             ///< fields of the path, [field]
  std::vector<Complex> field_derivative_;  ///< derivatives of the fields, [parameter][field]
};

/// Scores the fields of paths with their derivatives. Terms is a class that computes the fields of
/// a path in all channels and adds them to sums. The members of Terms are
///   Tally                                  tally of a path (TallyScorer)
///   Endpoints                              data of a list of endpoints; `value` is A e of C14
///   endpoints(n)                           makes the Endpoints of n endpoints
///   attenuate(endpoints, x, out)           computes `out` for rays from x, without scattering
///   turn(endpoints, x, arrival, out)       adds the scattering at x towards the endpoints
///   inner(tally, first)                    data of a path of B >= 2 without its endpoints
///   one(x, from, to)                       data of a path of B = 1 without its endpoints
///   clear()                                begins a path
///   add_term(channel, term, inner,         adds a term (F or R of C14) of the field of a
///            lights, i, views, v)          channel, from light i to view v
///   accumulate(weight)                     adds the path to the sums
template <typename Terms>
class DerivativeScorer : public TallyScorer<typename Terms::Tally> {
  using Endpoints = typename Terms::Endpoints;

 public:
  DerivativeScorer(const PathWalks& walks, const typename Terms::Tally& none, Terms terms)
      : TallyScorer<typename Terms::Tally>(none),
        channels_(walks.scene().request.channels),
        walks_(walks),
        terms_(std::move(terms)),
        endpoints_(walks, [this](std::size_t endpoints) { return terms_.endpoints(endpoints); }) {}

  /// Scores the path of one scatterer at x.
  void single(Vec x, double weight, FaceWaves waves) override {
    endpoints_.choose(waves);
    EndpointFactors &lights = endpoints_.lights(), &views = endpoints_.views();
    Endpoints &light = endpoints_.light_last, &view = endpoints_.view_last;
    terms_.attenuate(lights, x, light);
    terms_.attenuate(views, x, view);
    terms_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec from = -lights.direction(i), to = views.direction(v);
      terms_.add_term(
          c, product(product(light.value[i], view.value[v]), walks_.amplitude(x, from, to)),
          terms_.one(x, from, to), light, i, view, v);
    }
    terms_.accumulate(weight);
  }

  void multiple(const Path& path) override {
    endpoints_.find(path, [this](EndpointFactors& endpoints, Vec x, Vec arrival, Endpoints& out) {
      terms_.attenuate(endpoints, x, out);
      walks_.towards(x, arrival, endpoints.directions(), out.value);
      terms_.turn(endpoints, x, arrival, out);
    });
    const auto& inner = terms_.inner(this->tally(), path.first);
    terms_.clear();
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      add_term(c, inner, endpoints_.light_first, endpoints_.view_last);
      if (endpoints_.reversed()) add_term(c, inner, endpoints_.light_last, endpoints_.view_first);
    }
    terms_.accumulate(path.weight);
  }

 private:
  template <typename Inner>
  void add_term(std::size_t c, const Inner& inner, const Endpoints& lights,
                const Endpoints& views) {
    const auto [i, v] = channels_[c];
    terms_.add_term(c, product(lights.value[i], views.value[v]), inner, lights, i, views, v);
  }

  const std::vector<Channel>& channels_;
  const PathWalks& walks_;
  Terms terms_;
  PathEndpoints<Endpoints> endpoints_;
};

}  // namespace flatspeckle::mc
