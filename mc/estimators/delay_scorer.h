#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/numbers/phasor.h"
#include "flatland/scene/scene.h"
#include "mc/ends/end_factors.h"
#include "mc/walk/path_walk.h"

namespace flatspeckle::mc {

/// 1 - cos of the angle between unit vectors.
inline double one_minus_cosine(Vec2 from, Vec2 to) {
  const Vec2 step = to - from;
  return dot(step, step) / 2;
}

/// Sum of 1 - cos over the inner scatterers of a path.
struct TurnTally {
  double turn = 0;

  void flight(double) {}
  void scattering(Vec2 from, Vec2 to) { turn += one_minus_cosine(from, to); }
};

/// Adds weight |f|^2 of every channel, then weight Re f(0) conj(f(t)) for every delay. C14's F and
/// R turn by other angles at the path's ends, so each has its own decay.
template <typename Scattering, bool reversed, bool phases>
class DelayScorer {
 public:
  DelayScorer(const Scene& scene, const Scattering& scattering, std::span<const double> delays,
              std::span<Complex> sums)
      : channels_(scene.request.channels),
        scattering_(scattering),
        delays_(delays),
        sums_(sums),
        lights_(scene, light_ends(scene)),
        views_(scene, view_ends(scene)),
        light_first_(lights_.size(), delays.size()),
        light_last_(light_first_),
        view_first_(views_.size(), delays.size()),
        view_last_(view_first_),
        inner_(1, delays.size()),
        exponent_(delays.size() * std::max(lights_.size(), views_.size())) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    lights_.attenuate(x, light_last_.value);
    views_.attenuate(x, view_last_.value);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      const Vec2 from = -lights_.direction(i), to = views_.direction(v);
      const double square =
          std::norm(light_last_.value[i] * view_last_.value[v] * scattering_.amplitude(from, to));
      sums_[c] += weight * square;
      inner_.turn[0] = one_minus_cosine(from, to);
      decay(inner_);
      for (std::size_t t = 0; t < delays_.size(); ++t)
        sums_[(1 + t) * channels_.size() + c] += weight * square * inner_.decay[t];
    }
  }

  void multiple(const TalliedPath<TurnTally>& path) {
    if (path.new_start) {
      at(lights_, path.first, -path.start, light_first_);
      if constexpr (reversed) at(views_, path.first, -path.start, view_first_);
    }
    at(views_, path.last, path.arrival, view_last_);
    if constexpr (reversed) at(lights_, path.last, path.arrival, light_last_);
    inner_.turn[0] = path.tally.turn;
    decay(inner_);
    for (std::size_t c = 0; c < channels_.size(); ++c) score(c, path.weight);
  }

 private:
  using Ends = EndFactors<true, phases>;
  /// A e of some ends and how they decay, [delay][end].
  struct Decaying {
    std::vector<Complex> value;
    std::vector<double> turn, decay;

    Decaying(std::size_t ends, std::size_t delays)
        : value(ends), turn(ends), decay(ends * delays) {}
  };

  void decay(Decaying& ends) {
    const std::size_t count = ends.turn.size();
    for (std::size_t t = 0; t < delays_.size(); ++t)
      for (std::size_t j = 0; j < count; ++j)
        exponent_[t * count + j] = -2 * delays_[t] * ends.turn[j];
    damping(std::span(exponent_).first(ends.decay.size()), ends.decay);
  }

  void at(Ends& ends, Vec2 x, Vec2 arrival, Decaying& out) {
    ends.at(x, arrival, scattering_, out.value);
    for (std::size_t j = 0; j < ends.size(); ++j)
      out.turn[j] = one_minus_cosine(arrival, ends.direction(j));
    decay(out);
  }

  void score(std::size_t c, double weight) {
    const auto [i, v] = channels_[c];
    const Complex forward = product(light_first_.value[i], view_last_.value[v]);
    Complex backward = 0;
    if constexpr (reversed) backward = product(light_last_.value[i], view_first_.value[v]);
    const Complex field = forward + backward;
    const double with_forward = weight * product_with_conjugate(field, forward).real(),
                 with_backward = weight * product_with_conjugate(field, backward).real();
    sums_[c] += with_forward + with_backward;
    for (std::size_t t = 0; t < delays_.size(); ++t) {
      double sum = with_forward * light_first_.decay[t * lights_.size() + i] *
                   view_last_.decay[t * views_.size() + v];
      if constexpr (reversed)
        sum += with_backward * light_last_.decay[t * lights_.size() + i] *
               view_first_.decay[t * views_.size() + v];
      sums_[(1 + t) * channels_.size() + c] += inner_.decay[t] * sum;
    }
  }

  const std::vector<Channel>& channels_;
  const Scattering& scattering_;
  std::span<const double> delays_;
  std::span<Complex> sums_;
  Ends lights_, views_;
  Decaying light_first_, light_last_, view_first_, view_last_;
  Decaying inner_;  ///< of the inner scatterers, or the only one
  std::vector<double> exponent_;
};

}  // namespace flatspeckle::mc
