#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>

#include "flatland/scene/scene.h"
#include "mc/ends/scattering.h"
#include "mc/walk/path_walk.h"
#include "mc/walk/plan.h"

namespace flatspeckle::mc {

/// Adds batch `number` to zeroed sums.
using SummedBatches = std::function<void(std::uint64_t number, std::span<Complex> sums)>;

/// Calls f with std::true_type or std::false_type.
template <typename F>
void with_flag(bool flag, F f) {
  if (flag)
    f(std::true_type{});
  else
    f(std::false_type{});
}

/// Calls f with a scene's scattering in one of its forms.
template <typename F>
void with_scattering(const Scene& scene, Plan::Phase phase, F f) {
  switch (phase) {
    case Plan::Phase::isotropic:
      return f(IsotropicScattering{});
    case Plan::Phase::henyey_greenstein:
      return f(HenyeyGreensteinScattering{{scene.scatterer.g}});
    case Plan::Phase::tabulated:
      return f(TabulatedScattering(scene.medium, scene.k));
  }
}

/// What all batches of walks share.
template <typename Scattering, bool reversed, bool weighted, typename Tally = NoTally>
struct WalkSetup {
  WalkSetup(const Scene& its_scene, const Plan& its_plan, const Scattering& its_scattering,
            Tally tally = {})
      : scene(its_scene),
        plan(its_plan),
        scattering(its_scattering),
        walk(scene, plan, scattering, tally) {}
  WalkSetup(const WalkSetup&) = delete;

  /// Gives a scorer the paths of one batch.
  template <typename Scorer>
  void walk_batch(std::uint64_t seed, std::uint64_t number, Scorer& scorer) const {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
    auto own = walk;
    own.begin(random);
    for (std::uint64_t path = 0; path < plan.paths_per_batch; ++path) own.walk(random, scorer);
  }

  const Scene scene;
  const Plan plan;
  const Scattering scattering;
  const PathWalk<Scattering, reversed, weighted, Tally> walk;
};

}  // namespace flatspeckle::mc
