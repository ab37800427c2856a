#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.h"
#include "flatland/scene.h"
#include "grin/free_flight.h"
#include "mc/first_scatterer.h"
#include "mc/importance.h"
#include "mc/plan.h"
#include "mc/scattering.h"

namespace flatspeckle::mc {

/// A path of B >= 2 scatterers as the walk found it. The mean of weight f_a conj(f_b) over walks is
/// the covariance, with f = F, or F + R with reversed paths (conventions, C14), whose amplitudes are
/// divided by sqrt(sigma_s).
struct Path {
  Vec2 first, start;    ///< the first scatterer and the direction to the second
  Vec2 last, arrival;   ///< the last one and the direction in which it is reached
  double weight = 0;
  bool new_start = false;  ///< the first such path from this first scatterer and start
};

/// Walks from the lights through a scene (Bar et al. 2019) and gives what it finds to a scorer:
///   single(x, weight)   paths of one scatterer, where the plan samples them
///   multiple(path)      paths of more
/// Steps are cheap and scoring is not, so a contribution that promises little plays roulette first.
/// Walkers split and die by what their depth is worth.
///
/// With reversed paths a path is weighed by the mean of the densities with which the walk would find
/// it from either end. That is unbiased, because F + R does not change when a path is turned round,
/// and no |R|^2 can outgrow its weight.
template <typename Scattering, bool reversed, bool weighted>
class PathWalk {
 public:
  PathWalk(const Scene& scene, const Plan& plan, const Scattering& scattering)
      : plan_(plan),
        domain_(scene.domain),
        medium_(scene.medium),
        scattering_(scattering),
        first_(scene),
        importance_(scene),
        expected_view_(scene, view_ends(scene)) {}

  /// To be called before a batch's first walk.
  void begin(RandomStream& random) { ticket_ = random.uniform(); }

  template <typename Scorer>
  void walk(RandomStream& random, Scorer& scorer) {
    const auto [x, arrival] = first_.sample(random);
    if (plan_.sampled_single) scorer.single(x, medium_.mu_s / first_.density(x));
    path_ = {x, scattering_.sample(arrival, random), {}, {}, 0, true};
    start_density_ = -1;
    if constexpr (reversed) expected_first_ = expected(x, -path_.start);
    fly(x, path_.start, 1, random, scorer);
    while (!waiting_.empty()) {
      const Walker walker = waiting_.back();
      if (--waiting_.back().copies == 0) waiting_.pop_back();
      fly(walker.x, scattering_.sample(walker.arrival, random), walker.weight, random, scorer);
    }
  }

 private:
  /// Weights in units of mu_s^2 / mu_t, that of B = 2.
  struct Walker {
    Vec2 x, arrival;
    double weight;
    std::uint32_t copies;
  };

  /// From a scatterer on, until the walker leaves, dies or splits.
  template <typename Scorer>
  void fly(Vec2 x, Vec2 w, double weight, RandomStream& random, Scorer& scorer) {
    while (true) {
      const double flight = grin::sample_free_flight(medium_.mu_t, random.uniform());
      if (flight >= domain_.distance_to_edge(x, w)) return;
      x = x + flight * w;
      score(x, w, weight, scorer);
      if constexpr (weighted) {
        if (!reweigh(x, w, weight, random)) return;
      }
      w = scattering_.sample(w, random);
    }
  }

  /// The weight window: false if the walker died, or waits as several.
  bool reweigh(Vec2 x, Vec2 arrival, double& weight, RandomStream& random) {
    weight *= medium_.albedo;
    const double worth = weight * importance_(x.z);
    if (worth < 0.5) {
      weight /= worth;
      return random.uniform() < worth;
    }
    if (worth < 2) return true;
    const auto copies = static_cast<std::uint32_t>(worth + random.uniform());
    waiting_.push_back({x, arrival, weight / worth, copies});
    return false;
  }

  /// Contributions that promise less than a score play systematic roulette: every so many of them,
  /// measured in what they promise, one is taken for all.
  template <typename Scorer>
  void score(Vec2 x, Vec2 arrival, double weight, Scorer& scorer) {
    double promise = expected(x, arrival), backward_density = 0;
    if constexpr (reversed) {
      backward_density = first_.density(x, -arrival, scattering_);
      const double forward = start_density();
      promise = (forward * promise + backward_density * expected_first_) /
                (forward + backward_density);
    }
    const double chance = promise * weight / plan_.score_level;
    if (chance < 1) {
      ticket_ += chance;
      if (ticket_ < 1) return;
      ticket_ -= 1;
      weight /= chance;
    }
    path_.last = x;
    path_.arrival = arrival;
    path_.weight = medium_.mu_s * medium_.albedo * weight / (start_density() + backward_density);
    scorer.multiple(path_);
    path_.new_start = false;
  }

  /// What a path that ends at x is likely to contribute, for a walker of usual weight there.
  double expected(Vec2 x, Vec2 arrival) const {
    const double value = expected_view_(x, arrival);
    if constexpr (weighted) return value * importance_(x.z);
    return value;
  }

  /// Computed when it is first asked for: many walks never score.
  double start_density() {
    if (start_density_ < 0) start_density_ = first_.density(path_.first, path_.start, scattering_);
    return start_density_;
  }

  const Plan& plan_;
  Domain domain_;
  const BulkMedium& medium_;
  const Scattering& scattering_;
  FirstScatterer first_;
  DepthImportance importance_;
  ExpectedContribution expected_view_;
  std::vector<Walker> waiting_;
  Path path_;
  double start_density_ = -1, expected_first_ = 0;
  double ticket_ = 0;  ///< a score at every whole number
};

}  // namespace flatspeckle::mc
